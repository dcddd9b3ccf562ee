#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::calibration {

/// What a scan can be asked about itself. Never renumbered: names and numbers are stored.
enum class CheckKind : std::uint8_t {
  Closure,      ///< the standard, read again or read as the sample, is what its certificate and table say
  Reciprocity,  ///< f_r(i, r) = f_r(r, i)
  LeftRight,    ///< f_r(phi) = f_r(-phi), of an isotropic sample
  Energy,       ///< no direction of light is sent back with more than it brought
  Repeats,      ///< points of one geometry and check visits of the sample agree
  DarkHistory,  ///< the dark level lies where its neighbours say it does
  Exposures,    ///< readings of one point at several exposures agree
};
inline constexpr std::array<CheckKind, 7> kAllChecks{
    CheckKind::Closure, CheckKind::Reciprocity, CheckKind::LeftRight, CheckKind::Energy,
    CheckKind::Repeats, CheckKind::DarkHistory, CheckKind::Exposures};
/// "closure", "reciprocity", "left-right", "energy", "repeats", "dark-history", "exposures".
[[nodiscard]] std::string_view check_name(CheckKind kind);

enum class CheckVerdict : std::uint8_t { Passed, Failed, NothingToCompare };
/// "passed", "failed", "nothing to compare".
[[nodiscard]] std::string_view verdict_name(CheckVerdict verdict);

/// How one check came out.
struct ScanCheck {
  CheckKind kind = CheckKind::Closure;
  CheckVerdict verdict = CheckVerdict::NothingToCompare;
  std::size_t compared = 0;  ///< pairs, readings, directions of light: what `unit` says
  std::string unit;
  double chi_square = 0.0;  ///< of all together; 0 where the check makes none
  double degrees_of_freedom = 0.0;
  double worst_z = 0.0;  ///< the largest deviation in its own u
  /// The probability of a chi-square or a worst z as large as these, if the scan is good and its uncertainties true.
  double p_value = 1.0;
  std::vector<std::int32_t> worst_points;  ///< by index; empty where visits are compared
  std::string finding;                     ///< one sentence, whatever the verdict
};

/// A check of a good scan fails with at most this probability; all seven together with at most seven times it.
inline constexpr double kFalseAlarm = 1e-3;

}  // namespace gonio::calibration
