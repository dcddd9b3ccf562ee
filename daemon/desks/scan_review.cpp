#include "daemon/desks/scan_review.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/calibrate.h"
#include "calibration/checks/check_scan.h"
#include "calibration/point_flags.h"
#include "daemon/config/instrument.h"
#include "daemon/results/version_desk.h"

namespace gonio::daemon {
namespace {

using calibration::CalibratedPoint;
using calibration::CalibratedScan;

/// A scan calibrated anew: what the store keeps of a budget has its random part in one number.
struct Review {
  ScanInfo info;
  calibration::InstrumentModel instrument;
  calibration::ReferenceStandard standard;
  calibration::ScanReadings readings;
  CalibratedScan calibrated;
};

// With the versions of the newest BRDF; of a scan without one, with those that count now.
Result<ModelOfVersions> model_in_force(StoreReader& reader, ScanId scan, const Instrument& instrument,
                                       const calibration::ScanReadings& readings) {
  const Result<std::vector<FoundCalibration>> found = reader.found_calibrations();
  if (!found) return failure(found.error());
  const Result<BrdfInfo> stored = reader.brdf(scan);
  if (!stored && stored.error().code != ErrorCode::NotFound) return failure(stored.error());
  return model_with(*found, stored ? AskedVersions(stored->versions) : AskedVersions(), instrument, readings);
}

Result<Review> review_of(StoreReader& reader, ScanId scan) {
  Result<ScanInfo> info = reader.scan(scan);
  if (!info) return failure(info.error());
  const Result<ScanTexts> texts = reader.texts(scan);
  if (!texts) return failure(texts.error());
  const Result<Instrument> instrument = parse_instrument(texts->instrument, "the scan's instrument.toml");
  if (!instrument) return failure(instrument.error());
  auto standard = calibration::ReferenceStandard::parse(texts->reference, "the scan's reference");
  if (!standard) return failure(standard.error());
  Result<calibration::ScanReadings> readings = reader.readings(scan, instrument->stage);
  if (!readings) return failure(readings.error());
  Result<ModelOfVersions> chosen = model_in_force(reader, scan, *instrument, *readings);
  if (!chosen) return failure(chosen.error());
  auto calibrated = calibration::calibrate(*readings, chosen->model, *standard, info->submitted);
  if (!calibrated) return failure(calibrated.error());
  return Review{std::move(*info), std::move(chosen->model), std::move(*standard), std::move(*readings),
                std::move(*calibrated)};
}

api::ScanCheckReport report_of_check(const calibration::ScanCheck& check) {
  return {.name = std::string(calibration::check_name(check.kind)),
          .verdict = std::string(calibration::verdict_name(check.verdict)),
          .compared = static_cast<std::int64_t>(check.compared),
          .unit = check.unit,
          .chi_square = check.chi_square,
          .degrees_of_freedom = check.degrees_of_freedom,
          .worst_z = check.worst_z,
          .p_value = check.p_value,
          .worst_points = {check.worst_points.begin(), check.worst_points.end()},
          .finding = check.finding};
}

Error no_budget(ErrorCode code, std::int64_t point, std::string seen) {
  return {.code = code,
          .device = "store",
          .tried = fmt::format("show the budget of point {}", point),
          .seen = std::move(seen),
          .limit = {}};
}

Result<const CalibratedPoint*> asked_point(const CalibratedScan& scan, std::int64_t index) {
  for (const CalibratedPoint& point : scan.points) {
    if (point.point_index == index) return &point;
  }
  for (const calibration::RefusedPoint& refused : scan.refused) {
    if (refused.point_index == index) {
      return failure(no_budget(ErrorCode::IncompleteData, index, "it has no value: " + describe(refused.reason)));
    }
  }
  return failure(no_budget(ErrorCode::NotFound, index, "no value of such a point"));
}

// Of those that are told from zero, where there are any.
Result<const CalibratedPoint*> median_point(const CalibratedScan& scan) {
  std::vector<std::pair<double, const CalibratedPoint*>> by_u;
  for (const CalibratedPoint& point : scan.points) {
    if (has(point.flags, calibration::PointFlag::NearZero) || point.value.si() == 0.0) continue;
    by_u.emplace_back(point.budget.expanded.si() / std::abs(point.value.si()), &point);
  }
  if (by_u.empty() && !scan.points.empty()) return &scan.points.front();
  if (by_u.empty()) return failure(no_budget(ErrorCode::NotFound, 0, "the scan has no value yet"));
  std::ranges::stable_sort(by_u, {}, &std::pair<double, const CalibratedPoint*>::first);
  return by_u[(by_u.size() - 1) / 2].second;
}

std::optional<double> finite(double value) {
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

const char* distribution_word(calibration::Distribution distribution) {
  switch (distribution) {
    case calibration::Distribution::Rectangular:
      return "rectangular";
    case calibration::Distribution::Arcsine:
      return "arcsine";
    case calibration::Distribution::Normal:
      break;
  }
  return "normal";
}

api::BudgetTermReport term_report(const calibration::BudgetTerm& term, const calibration::Component& component,
                                  double variance) {
  const double per_sd = term.per_sd.si();
  api::BudgetTermReport report{.component = component.name,
                               .kind = component.kind == calibration::ComponentKind::Shared ? "shared" : "random",
                               .distribution = distribution_word(component.distribution),
                               .u = std::nullopt,
                               .unit = component.unit,
                               .sensitivity = std::nullopt,
                               .contribution_per_sr = std::abs(per_sd),
                               .share_percent = variance > 0.0 ? 100.0 * per_sd * per_sd / variance : 0.0,
                               .degrees_of_freedom = finite(component.degrees_of_freedom)};
  if (component.u > 0.0) {
    report.u = component.u;
    report.sensitivity = per_sd / component.u;
  }
  return report;
}

std::string method_words(const calibration::Budget& budget) {
  switch (budget.method) {
    case calibration::BudgetMethod::MonteCarlo:
      return "Monte Carlo (JCGM 101:2008); the shares are those of the linear terms";
    case calibration::BudgetMethod::FormulaWithBounds:
      return "law of propagation (JCGM 100:2008, eq 13), k of normal errors and of some with bounds for 95.45 %";
    case calibration::BudgetMethod::Formula:
      break;
  }
  return "law of propagation (JCGM 100:2008, eq 13), k by Welch-Satterthwaite (eq G.2b) for 95.45 %";
}

api::PointBudgetReport budget_report(const CalibratedScan& scan, const CalibratedPoint& point) {
  const calibration::Budget& budget = point.budget;
  const Geometry& g = point.geometry;
  api::PointBudgetReport report{.point = point.point_index,
                                .chosen = {},
                                .theta_i_deg = in_degrees(g.theta_i),
                                .phi_i_deg = in_degrees(g.phi_i),
                                .theta_r_deg = in_degrees(g.theta_r),
                                .phi_r_deg = in_degrees(g.phi_r),
                                .wavelength_nm = in_nanometres(point.wavelength),
                                .brdf_per_sr = point.value.si(),
                                .u_random_per_sr = budget.u_random.si(),
                                .u_shared_per_sr = budget.u_shared.si(),
                                .u_per_sr = budget.u.si(),
                                .degrees_of_freedom = finite(budget.degrees_of_freedom),
                                .k = budget.k,
                                .expanded_u_per_sr = budget.expanded.si(),
                                .below_per_sr = budget.below.si(),
                                .above_per_sr = budget.above.si(),
                                .method = method_words(budget),
                                .flags = calibration::flag_words(point.flags),
                                .terms = {}};
  double variance = 0.0;
  for (const auto* terms : {&budget.random, &budget.shared}) {
    for (const calibration::BudgetTerm& term : *terms) variance += term.per_sd.si() * term.per_sd.si();
  }
  for (const auto* terms : {&budget.random, &budget.shared}) {
    for (const calibration::BudgetTerm& term : *terms) {
      report.terms.push_back(term_report(term, scan.components[term.component], variance));
    }
  }
  std::ranges::stable_sort(report.terms, std::ranges::greater{}, &api::BudgetTermReport::share_percent);
  return report;
}

}  // namespace

Result<api::ScanChecksReport> checks_of(StoreReader& reader, ScanId scan) {
  const Result<Review> review = review_of(reader, scan);
  if (!review) return failure(review.error());
  const auto checks = calibration::check_scan(
      review->calibrated, {.scan = review->readings,
                           .instrument = review->instrument,
                           .standard = review->standard,
                           .sample_is_the_standard = review->info.sample == review->standard.serial()});
  api::ScanChecksReport report{
      .scan = scan, .summary = calibration::summary_of(checks), .false_alarm = calibration::kFalseAlarm, .checks = {}};
  for (const calibration::ScanCheck& check : checks) report.checks.push_back(report_of_check(check));
  return report;
}

Result<api::PointBudgetReport> budget_of_point(StoreReader& reader, ScanId scan, std::optional<std::int64_t> point) {
  const Result<Review> review = review_of(reader, scan);
  if (!review) return failure(review.error());
  const auto found = point ? asked_point(review->calibrated, *point) : median_point(review->calibrated);
  if (!found) return failure(found.error());
  api::PointBudgetReport report = budget_report(review->calibrated, **found);
  report.scan = scan;
  report.chosen = point ? "asked for" : "the point of median U / |f|";
  return report;
}

}  // namespace gonio::daemon
