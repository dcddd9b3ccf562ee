#include "daemon/sequencer/failure_policy.h"

namespace gonio::daemon {

namespace {

// A radiometer whose endpoint stalled has been cleared by its driver, and may be asked again. A monitor in overload
// says nothing about the item: the next one would fail likewise.
bool is_of_a_meter_that_may_be_asked_again(const Error& error) {
  if (error.code == ErrorCode::DeviceRefused) return error.device == "detector" || error.device == "monitor";
  return error.code == ErrorCode::Saturated && error.device == "monitor";
}

}  // namespace

Reaction reaction_to(const Error& error) {
  if (is_of_a_meter_that_may_be_asked_again(error)) return Reaction::TryAgainThenHold;
  switch (error.code) {
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
