// Reciprocity, left and right.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "calibration/checks/check_parts.h"
#include "reflectance/check/symmetry_check.h"

namespace gonio::calibration {
namespace {

constexpr std::size_t kPointsAtMost = 50'000;  // of one wavelength: some seconds

struct PointsOfAWavelength {
  std::vector<reflectance::SymmetryPoint> points;
  std::vector<const CalibratedPoint*> calibrated;
};

std::map<std::int64_t, PointsOfAWavelength> by_wavelength(const CalibratedScan& scan) {
  std::map<std::int64_t, PointsOfAWavelength> parts;
  for (const CalibratedPoint& point : scan.points) {
    PointsOfAWavelength& part = parts[std::llround(in_nanometres(point.wavelength) * 1e3)];
    if (part.points.size() == kPointsAtMost) continue;
    auto made = symmetry_point(point, scan.components);
    if (!made) continue;
    part.points.push_back(std::move(*made));
    part.calibrated.push_back(&point);
  }
  return parts;
}

void keep_worst(ScanCheck& check, const reflectance::SymmetryGap& gap, const PointsOfAWavelength& part) {
  if (std::abs(gap.z) < std::abs(check.worst_z) || !std::isfinite(gap.z)) return;
  check.worst_z = gap.z;
  check.worst_points = {part.calibrated[gap.first]->point_index, part.calibrated[gap.second]->point_index};
}

std::string sentence_of(const ScanCheck& check, std::string_view what) {
  if (check.compared == 0) return fmt::format("no {} among its points", check.unit);
  std::string text = fmt::format("{} {}: chi-square {:.1f} for {:.0f} degrees of freedom, worst {:+.1f} u",
                                 check.compared, check.unit, check.chi_square, check.degrees_of_freedom, check.worst_z);
  if (check.worst_points.size() == 2) {
    text += fmt::format(" between points {} and {}", check.worst_points[0], check.worst_points[1]);
  }
  return check.verdict == CheckVerdict::Failed ? text + ": " + std::string(what) : text;
}

ScanCheck symmetry_of(const CalibratedScan& calibrated, ScanCheck check, reflectance::Symmetry symmetry,
                      const reflectance::SymmetryOptions& options, std::string_view what) {
  for (const auto& [wavelength, part] : by_wavelength(calibrated)) {
    const auto report = reflectance::check_symmetry(symmetry, part.points, options);
    if (!report) {
      check.finding = "not decided: " + describe(report.error());
      return check;
    }
    check.compared += report->gaps.size();
    check.chi_square += report->chi2;
    check.degrees_of_freedom += static_cast<double>(report->degrees_of_freedom);
    for (const auto& gap : report->gaps) keep_worst(check, gap, part);
  }
  judge(check, check.compared);
  check.finding = sentence_of(check, what);
  return check;
}

}  // namespace

ScanCheck check_reciprocity(const CalibratedScan& calibrated, const CheckInputs& inputs) {
  const reflectance::SymmetryOptions options{.sameness = inputs.scan.isotropic ? reflectance::Sameness::TurnedOrMirrored
                                                                               : reflectance::Sameness::Exact};
  return symmetry_of(calibrated, {.kind = CheckKind::Reciprocity, .unit = "exchanged pairs"},
                     reflectance::Symmetry::Reciprocity, options,
                     "angles are off, light strays, or the uncertainties are too small");
}

ScanCheck check_left_right(const CalibratedScan& calibrated, const CheckInputs& inputs) {
  ScanCheck check{.kind = CheckKind::LeftRight, .unit = "mirrored pairs"};
  if (!inputs.scan.isotropic) {
    check.finding = "the sample is not said to be isotropic: left and right may differ";
    return check;
  }
  return symmetry_of(calibrated, std::move(check), reflectance::Symmetry::LeftRight,
                     {.sameness = reflectance::Sameness::Turned},
                     "the sample is tilted, phi's zero is off, or light strays");
}

}  // namespace gonio::calibration
