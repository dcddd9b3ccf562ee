#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gonio {

/// Every way in which something can fail, as one closed list. A code is never renamed and never used for something
/// else: it stands in databases, in API answers and in operators' notes. What each means is in the table behind
/// `traits`.
enum class ErrorCode : std::uint8_t {
  // input
  InvalidInput,
  UnknownKey,
  MissingKey,
  OutOfLimits,
  Blocked,
  AllPointsBlocked,
  ReferenceExpired,
  ReferenceIncomplete,
  ReferenceOutOfReach,
  FileUnreadable,
  // requests
  NotFound,
  WrongState,
  ControlHeld,
  NotAuthorised,
  ForbiddenOrigin,
  UnsupportedMediaType,
  TooLarge,
  // start-up
  PortBusy,
  StoreLocked,
  StoreTooNew,
  NoDaemon,
  // devices
  Unreachable,
  TimedOut,
  WrongDevice,
  BadReply,
  DeviceRefused,
  DeviceFault,
  NotHomed,
  Stopped,
  StaleEpoch,
  MotionLate,
  OutOfTolerance,
  PositionLost,
  HeartbeatTripped,
  Interlock,
  ControlLost,
  IncompleteData,
  StaleData,
  Saturated,
  SettingNotTaken,
  // store and the rest
  StoreFailed,
  DiskFull,
  Busy,
  ReplayDiffers,
  Internal,
};

/// Whether trying the same thing again can help.
enum class Retry : std::uint8_t { Never, Again, AfterOperator };

/// What a code means, wherever it is shown: one row serves problem+json, the CLI, the operator's docs and scan policy.
struct ErrorTraits {
  ErrorCode code;
  std::string_view name;  ///< stable, kebab-case: "out-of-limits"
  int http_status;
  int exit_code;  ///< of gonioctl: 1 failed, 2 usage, 3 no daemon, 4 not authorised, 5 held, 6 limit, 7 timeout
  Retry retry;
  std::string_view title;         ///< a few words for people
  std::string_view for_the_data;  ///< what it means for what was measured
  std::string_view remedy;        ///< what to do
};

[[nodiscard]] const ErrorTraits& traits(ErrorCode code);
[[nodiscard]] std::optional<ErrorCode> error_code_from_name(std::string_view name);
[[nodiscard]] std::span<const ErrorTraits> all_error_traits();

/// Where in the user's text an input error stands. `line` 0: not known.
struct InputLocation {
  std::string file;
  int line = 0;
  std::string field;
  friend bool operator==(const InputLocation&, const InputLocation&) = default;
};

/// One failure, as a value: compared in tests, stored, sent over REST, shown to people.
struct Error {
  ErrorCode code = ErrorCode::Internal;
  std::string device;  ///< its role: "stage", "detector", "store", or the file for input; may be empty
  std::string tried;   ///< "move theta_r to 97.200 deg"
  std::string seen;    ///< "target 97.200 deg", value and unit
  std::string limit;   ///< "at most 90.000 deg"; may be empty
  std::optional<InputLocation> where = std::nullopt;
  friend bool operator==(const Error&, const Error&) = default;
};

/// One sentence: who, what was tried, what was seen, the limit. No newline: control characters are shown as "\x0A".
[[nodiscard]] std::string describe(const Error& error);
/// As `describe`, then what it means for the data and what to do, each on its own line.
[[nodiscard]] std::string explain(const Error& error);

}  // namespace gonio
