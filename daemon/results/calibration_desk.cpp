#include "daemon/results/calibration_desk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "calibration/calibrate.h"
#include "calibration/reference_standard.h"
#include "daemon/config/configuration_hash.h"
#include "daemon/config/instrument.h"

namespace gonio::daemon {
namespace {

BrdfRow row_of(const calibration::CalibratedPoint& point) {
  BrdfRow row;
  row.point = point.point_index;
  row.value_per_sr = in_per_steradian(point.value);
  row.u_random_per_sr = in_per_steradian(point.budget.u_random);
  const double dof = point.budget.degrees_of_freedom;
  row.effective_dof = std::isfinite(dof) ? dof : 0.0;
  row.flags = point.flags;
  row.reported = point.geometry;
  for (const calibration::BudgetTerm& term : point.budget.shared) {
    row.sensitivities_per_sr.push_back(static_cast<double>(term.component));
    row.sensitivities_per_sr.push_back(in_per_steradian(term.per_sd));
  }
  if (point.budget.method != calibration::BudgetMethod::Formula) {
    row.interval = {.u_per_sr = in_per_steradian(point.budget.u),
                    .below_per_sr = in_per_steradian(point.budget.below),
                    .above_per_sr = in_per_steradian(point.budget.above)};
  }
  return row;
}

std::string component_text(const calibration::Component& component) {
  const std::string kind = component.kind == calibration::ComponentKind::Shared ? "shared" : "random";
  return component.name + " [" + kind + ", u in " + component.unit + "]";
}

std::string inputs_json(const ScanTexts& texts, const std::string& inputs) {
  return nlohmann::json{{"instrument_sha256", texts.instrument_sha256},
                        {"reference_sha256", texts.reference_sha256},
                        {"inputs_sha256", sha256_hex(inputs)}}
      .dump();
}

}  // namespace

Result<NewBrdf> compute_brdf(StoreReader& reader, ScanId scan, const AskedVersions& asked) {
  const Result<ScanTexts> texts = reader.texts(scan);
  if (!texts) return failure(texts.error());
  const Result<Instrument> instrument = parse_instrument(texts->instrument, "the scan's instrument.toml");
  if (!instrument) return failure(instrument.error());
  const auto standard = calibration::ReferenceStandard::parse(texts->reference, "the scan's reference");
  if (!standard) return failure(standard.error());
  const Result<calibration::ScanReadings> readings = reader.readings(scan, instrument->stage);
  if (!readings) return failure(readings.error());
  const Result<std::vector<FoundCalibration>> found = reader.found_calibrations();
  if (!found) return failure(found.error());
  const Result<ModelOfVersions> chosen = model_with(*found, asked, *instrument, *readings);
  if (!chosen) return failure(chosen.error());
  const auto calibrated = calibration::calibrate(*readings, chosen->model, *standard, texts->submitted);
  if (!calibrated) return failure(calibrated.error());
  NewBrdf brdf{.scan = scan,
               .code_version = std::string(calibration::kCalibrationCode),
               .inputs_json = inputs_json(*texts, calibration::describe_inputs(chosen->model, *standard))};
  brdf.versions = chosen->versions;
  for (const calibration::Component& component : calibrated->components) {
    if (!component.is_pattern_known) brdf.sizes_only.push_back(static_cast<std::uint32_t>(brdf.component_names.size()));
    brdf.component_names.push_back(component_text(component));
  }
  for (const calibration::CalibratedPoint& point : calibrated->points) brdf.rows.push_back(row_of(point));
  return brdf;
}

Result<BrdfInfo> brdf_of(StoreReader& reader, ScanId scan) {
  Result<BrdfInfo> stored = reader.brdf(scan);
  if (stored || stored.error().code != ErrorCode::NotFound) return stored;
  Result<NewBrdf> computed = compute_brdf(reader, scan);
  if (!computed) return failure(computed.error());
  return BrdfInfo{.calibration = 0,
                  .code_version = std::move(computed->code_version),
                  .inputs_json = std::move(computed->inputs_json),
                  .component_names = std::move(computed->component_names),
                  .rows = std::move(computed->rows),
                  .versions = std::move(computed->versions),
                  .sizes_only = std::move(computed->sizes_only)};
}

bool is_drawn_anew(std::string_view component) {
  return component.starts_with("dark ") || component.starts_with("reference visit ") ||
         component.starts_with("drift between visits ");
}

StoredBudget budget_of(const BrdfRow& row) {
  double shared = 0.0;  // pairs: component, sensitivity
  for (std::size_t i = 1; i < row.sensitivities_per_sr.size(); i += 2) {
    shared += row.sensitivities_per_sr[i] * row.sensitivities_per_sr[i];
  }
  StoredBudget budget;
  budget.u_shared_per_sr = std::sqrt(shared);
  budget.u_per_sr = std::sqrt(shared + row.u_random_per_sr * row.u_random_per_sr);
  budget.k = calibration::coverage_factor(row.effective_dof > 0.0 ? row.effective_dof
                                                                  : std::numeric_limits<double>::infinity());
  budget.expanded_per_sr = budget.k * budget.u_per_sr;
  budget.below_per_sr = budget.above_per_sr = budget.expanded_per_sr;
  if (!row.interval) return budget;
  budget.u_per_sr = row.interval->u_per_sr;
  budget.below_per_sr = row.interval->below_per_sr;
  budget.above_per_sr = row.interval->above_per_sr;
  budget.expanded_per_sr = std::max(budget.below_per_sr, budget.above_per_sr);
  if (budget.u_per_sr > 0.0) budget.k = budget.expanded_per_sr / budget.u_per_sr;
  return budget;
}

}  // namespace gonio::daemon
