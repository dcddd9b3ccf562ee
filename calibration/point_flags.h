#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "calibration/calibrated_scan.h"

namespace gonio::calibration {

/// A flag as every export, REST and gonioctl name it, and what it tells a reader.
struct FlagWord {
  PointFlag flag = PointFlag::NearZero;
  std::string_view name;
  std::string_view meaning;
};

/// All flags, in the order of their bits.
[[nodiscard]] std::span<const FlagWord> all_flag_words();

/// The names of the flags that are set, separated by blanks.
[[nodiscard]] std::string flag_words(std::uint32_t flags);

}  // namespace gonio::calibration
