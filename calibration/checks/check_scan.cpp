#include "calibration/checks/check_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/checks/check_parts.h"
#include "reflectance/check/chi_square.h"

namespace gonio::calibration {
namespace {

// Of each size without a sign its square joins what is random.
double unsigned_variance(const CalibratedPoint& point, std::span<const Component> components) {
  double variance = 0.0;
  for (const BudgetTerm& term : point.budget.shared) {
    const Component& component = components[term.component];
    if (component.is_pattern_known) continue;
    variance += widened(component.degrees_of_freedom) * term.per_sd.si() * term.per_sd.si();
  }
  return variance;
}

double random_variance(const CalibratedPoint& point, std::span<const Component> components) {
  double variance = 0.0;
  for (const BudgetTerm& term : point.budget.random) {
    variance += widened(components[term.component].degrees_of_freedom) * term.per_sd.si() * term.per_sd.si();
  }
  return variance;
}

std::string number_of_things(const ScanCheck& check) {
  return fmt::format("{} {}", check.compared, check.unit);
}

}  // namespace

std::string_view check_name(CheckKind kind) {
  constexpr std::array<std::string_view, kAllChecks.size()> kNames{"closure", "reciprocity",  "left-right", "energy",
                                                                   "repeats", "dark-history", "exposures"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view verdict_name(CheckVerdict verdict) {
  constexpr std::array<std::string_view, 3> kNames{"passed", "failed", "nothing to compare"};
  return kNames[static_cast<std::size_t>(verdict)];
}

double beyond(double z) {
  return std::erfc(std::abs(z) / std::sqrt(2.0));
}

double widened(double degrees_of_freedom) {
  if (!std::isfinite(degrees_of_freedom)) return 1.0;
  // The lower 0.1 % of chi-square over nu, by Wilson and Hilferty (1931): below three degrees it is of no use.
  constexpr double kLowestTail = 3.0902;
  const double nu = std::max(3.0, degrees_of_freedom);
  const double root = 1.0 - 2.0 / (9.0 * nu) - kLowestTail * std::sqrt(2.0 / (9.0 * nu));
  return 1.0 / (root * root * root);
}

void judge_by_worst(ScanCheck& check, std::size_t n) {
  check.p_value = n == 0 ? 1.0 : std::min(1.0, static_cast<double>(n) * beyond(check.worst_z));
  check.verdict = n == 0                        ? CheckVerdict::NothingToCompare
                  : check.p_value < kFalseAlarm ? CheckVerdict::Failed
                                                : CheckVerdict::Passed;
}

void judge(ScanCheck& check, std::size_t n) {
  judge_by_worst(check, n);
  if (n == 0 || check.degrees_of_freedom <= 0.0) return;
  const double by_all = reflectance::chi_square_probability(check.chi_square, check.degrees_of_freedom);
  check.p_value = std::min(1.0, 2.0 * std::min(check.p_value, by_all));
  check.verdict = check.p_value < kFalseAlarm ? CheckVerdict::Failed : CheckVerdict::Passed;
}

std::optional<reflectance::SymmetryPoint> symmetry_point(const CalibratedPoint& point,
                                                         std::span<const Component> components) {
  const double variance = random_variance(point, components) + unsigned_variance(point, components);
  if (!(variance > 0.0)) return std::nullopt;
  reflectance::SymmetryPoint out{
      .geometry = point.geometry, .value = point.value, .u_random = per_steradian(std::sqrt(variance)), .shared = {}};
  for (const BudgetTerm& term : point.budget.shared) {
    const Component& component = components[term.component];
    if (!component.is_pattern_known) continue;
    out.shared.push_back({term.component, std::sqrt(widened(component.degrees_of_freedom)) * term.per_sd});
  }
  return out;
}

void judge_groups(ScanCheck& check, std::span<const std::vector<reflectance::GroupMember>> groups, std::size_t n) {
  if (n == 0) return judge_by_worst(check, 0);
  const auto found = reflectance::group_chi_square(groups);
  if (!found) {
    check.verdict = CheckVerdict::NothingToCompare;
    check.finding = "not decided: " + describe(found.error());
    return;
  }
  check.chi_square += found->chi2;
  check.degrees_of_freedom += static_cast<double>(found->degrees_of_freedom);
  judge(check, n);
}

std::optional<LevelReading> level_of(const RawReading& raw, const ReadingContext& context) {
  auto reading = normalise(raw, context);
  if (!reading) return std::nullopt;
  double variance =
      widened(reading->noise_dof) * reading->u_noise * reading->u_noise + reading->u_monitor * reading->u_monitor;
  for (const DarkShare& share : reading->darks) {
    const double before =
        share.level.before == nullptr ? 0.0 : (1.0 - share.level.weight_after) * share.level.before->u_dn;
    const double after = share.level.after == nullptr ? 0.0 : share.level.weight_after * share.level.after->u_dn;
    const double exposure_s = static_cast<double>(share.rung.exposure_us) * 1e-6;
    const double drift = context.detector->u_dark_drift_dn_per_s * exposure_s * share.level.drift_widening;
    variance += share.dq_dlevel * share.dq_dlevel * (before * before + after * after + drift * drift);
  }
  if (!(variance > 0.0)) return std::nullopt;
  return LevelReading{.raw = &raw, .reading = std::move(*reading), .u = std::sqrt(variance)};
}

std::vector<ScanCheck> check_scan(const CalibratedScan& calibrated, const CheckInputs& inputs) {
  std::vector<ScanCheck> checks{check_closure(calibrated, inputs),
                                check_reciprocity(calibrated, inputs),
                                check_left_right(calibrated, inputs),
                                check_energy(calibrated, inputs),
                                check_repeats(calibrated, inputs),
                                check_dark_history(inputs),
                                check_exposures(inputs)};
  for (ScanCheck& check : checks) {
    if (!check.finding.empty()) continue;
    check.finding =
        check.verdict == CheckVerdict::NothingToCompare
            ? fmt::format("no {}", check.unit)
            : fmt::format("{}, worst {:.1f} u, p = {:.2g}", number_of_things(check), check.worst_z, check.p_value);
  }
  return checks;
}

std::string summary_of(const std::vector<ScanCheck>& checks) {
  std::string failed;
  std::size_t decided = 0;
  for (const ScanCheck& check : checks) {
    if (check.verdict != CheckVerdict::NothingToCompare) ++decided;
    if (check.verdict == CheckVerdict::Failed)
      failed += (failed.empty() ? "" : ", ") + std::string(check_name(check.kind));
  }
  if (!failed.empty()) return "failed: " + failed;
  if (decided == 0) return "nothing to compare";
  return fmt::format("passed: {} of {} had something to compare", decided, checks.size());
}

}  // namespace gonio::calibration
