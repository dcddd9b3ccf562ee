#pragma once

#include "base/error.h"

namespace gonio::drivers {

/// What a link says it has seen when a call gave way to a halt: Unreachable, as over a broken connection, and no
/// failing of the device.
inline constexpr const char* kGaveWay = "interrupted";

/// Whether a link's call failed because it gave way to a halt.
[[nodiscard]] inline bool gave_way(const Error& error) {
  return error.code == ErrorCode::Unreachable && error.seen == kGaveWay;
}

}  // namespace gonio::drivers
