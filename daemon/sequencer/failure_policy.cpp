#include "daemon/sequencer/failure_policy.h"

namespace gonio::daemon {

Reaction reaction_to(ErrorCode code) {
  switch (code) {
    case ErrorCode::MotionLate:
    case ErrorCode::OutOfTolerance:
    case ErrorCode::IncompleteData:
    case ErrorCode::StaleData:
      return Reaction::TryAgain;
    case ErrorCode::TimedOut:
    case ErrorCode::BadReply:
      return Reaction::TryAgainThenHold;
    case ErrorCode::Saturated:
    case ErrorCode::OutOfLimits:
    case ErrorCode::Blocked:
    case ErrorCode::InvalidInput:
      return Reaction::GiveUpItem;
    default:
      return Reaction::Hold;  // a device that is lost, stopped or at fault: nothing after it would be better
  }
}

HoldName hold_for(ErrorCode code) {
  if (code == ErrorCode::Stopped || code == ErrorCode::StaleEpoch) return HoldName::Operator;
  if (code == ErrorCode::Interlock) return HoldName::Door;
  return HoldName::Device;
}

}  // namespace gonio::daemon
