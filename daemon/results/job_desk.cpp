#include "daemon/results/job_desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "calibration/jobs/arm_zeros.h"
#include "calibration/jobs/control_chart.h"
#include "calibration/jobs/direct_beam.h"
#include "calibration/jobs/linearity_ladder.h"
#include "calibration/jobs/signature.h"
#include "daemon/config/instrument.h"
#include "daemon/results/brdf_means.h"
#include "daemon/results/map_run.h"
#include "daemon/results/transfer_run.h"
#include "daemon/results/version_desk.h"
#include "daemon/store/version_list.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {
namespace {

using calibration::FoundValues;

constexpr std::string_view kJobCode = "gonio-jobs-2";  // grows whenever the same readings would give other values
constexpr std::string_view kMeanReff = "mean_reff";
constexpr std::string_view kOwnU = "u_own_mean_reff";

Error no_run(std::string seen, std::string limit) {
  return {.code = ErrorCode::IncompleteData,
          .device = "check standard",
          .tried = "take its run",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

// The mean REFF of all points, and what of its uncertainty each run draws anew. Shared errors keep their correlation.
FoundValues run_of_check_standard(const NewBrdf& brdf) {
  std::vector<std::size_t> all(brdf.rows.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const BrdfMeans mean = means_of(brdf, {std::move(all)});
  return {.values = {{.name = std::string(kMeanReff), .unit = "1", .value = mean.values.front()},
                     {.name = std::string(kOwnU), .unit = "1", .value = mean.u_own.front()}},
          .covariance = {mean.covariance.front(), 0.0, 0.0, 0.0},
          .note = fmt::format("mean of {} points", brdf.rows.size())};
}

// Those that the planner has put into the beam at the wavelengths of the plan.
std::vector<calibration::Attenuator> attenuators_of(const Instrument& instrument,
                                                    const calibration::ScanReadings& readings) {
  std::vector<calibration::Attenuator> attenuators;
  for (const calibration::PlannedPoint& point : readings.points) {
    const Filter* filter = attenuated_filter_for(instrument, point.wavelength);
    if (filter != nullptr) attenuators.push_back({point.wavelength, *filter->attenuation});
  }
  return attenuators;
}

Result<FoundValues> fitted(const api::PlanCalibration& wanted, const calibration::ScanReadings& readings,
                           const Instrument& instrument, const calibration::InstrumentModel& stated,
                           const NewBrdf& brdf, const std::string& master) {
  switch (wanted.job) {
    case api::CalibrationJob::Linearity:
      return calibration::fit_linearity(readings, stated, {.order = wanted.order});
    case api::CalibrationJob::ArmZeros:
      return calibration::fit_arm_zeros(readings, stated, {.u_mirror = wanted.u_mirror});
    case api::CalibrationJob::DirectBeam:
      return calibration::fit_direct_beam(readings, stated, attenuators_of(instrument, readings));
    case api::CalibrationJob::Signature:
      return calibration::fit_signature(readings, stated);
    case api::CalibrationJob::Transfer:
      return transfer_of(brdf, readings, master);
    case api::CalibrationJob::CheckStandard:
    case api::CalibrationJob::DarkMap:  // of pixels, not of readings: map_run.h
    case api::CalibrationJob::FlatField:
      break;
  }
  if (brdf.rows.size() == readings.points.size()) return run_of_check_standard(brdf);
  return failure(no_run(fmt::format("{} of {} points have a value", brdf.rows.size(), readings.points.size()),
                        "all of them: a mean of other points is another quantity"));
}

// Of what was found before: all that the scan's BRDF was computed with, but for the zeros of the arms, which a job
// finds from the encoders' own angles.
Result<ModelOfVersions> model_of(const NewBrdf& brdf, StoreReader& reader, const Instrument& instrument,
                                 const calibration::ScanReadings& readings) {
  const Result<std::vector<FoundCalibration>> all = reader.found_calibrations();
  if (!all) return failure(all.error());
  Result<ModelOfVersions> chosen = model_with(*all, brdf.versions, instrument, readings);
  if (chosen) chosen->model.angles = instrument.model.angles;
  return chosen;
}

std::string inputs_of(ScanId scan, const ScanTexts& texts, const Instrument& instrument,
                      const calibration::ScanReadings& readings, const std::vector<CalibrationVersion>& versions) {
  std::size_t frames = 0;
  for (const calibration::RawReading& reading : readings.readings) frames += reading.frames.size();
  return nlohmann::json{{"scan", scan},
                        {"readings", readings.readings.size()},
                        {"frames", frames},
                        {"first_reading", readings.readings.empty() ? 0 : readings.readings.front().id},
                        {"last_reading", readings.readings.empty() ? 0 : readings.readings.back().id},
                        {"detector", instrument.detector.serial},
                        {"calibrations", version_list_text(versions)},
                        {"instrument_sha256", texts.instrument_sha256},
                        {"reference_sha256", texts.reference_sha256},
                        {"plan_sha256", texts.plan_sha256}}
      .dump();
}

double value_of(const FoundValues& found, std::string_view name) {
  const auto place = found.place_of(name);
  return place ? found.values[*place].value : 0.0;
}

// The newest fit of each scan, in the order of the scans.
std::map<ScanId, FoundCalibration> runs_of(const std::vector<FoundCalibration>& all, const std::string& standard) {
  std::map<ScanId, FoundCalibration> runs;
  for (const FoundCalibration& found : all) {
    if (found.job == calibration_job_name(api::CalibrationJob::CheckStandard) && found.sample == standard) {
      runs.insert_or_assign(found.scan, found);
    }
  }
  return runs;
}

std::string verdict_of(const calibration::ControlChart& chart) {
  constexpr std::size_t kNeeded = 5;
  if (chart.baseline == 0) return fmt::format("{} runs: limits come with the {}th", chart.runs.size(), kNeeded);
  const std::uint8_t last = chart.runs.back().broken;
  const auto out = std::ranges::count_if(chart.runs, [](const auto& run) { return run.broken != 0; });
  const std::string before = out == 0 ? "" : fmt::format("; {} of {} runs broke a rule", out, chart.runs.size());
  if (last == 0) return "the last run is in control" + before;
  return "OUT OF CONTROL: the last run is " + calibration::broken_rules_text(last) + before;
}

}  // namespace

Result<std::optional<NewFoundCalibration>> fit_job(StoreReader& reader, ScanId scan, const NewBrdf& brdf) {
  const Result<ScanTexts> texts = reader.texts(scan);
  if (!texts) return failure(texts.error());
  const Result<api::Plan> plan = api::parse_plan(texts->plan, texts->plan_file, texts->plan_parts);
  if (!plan || !plan->calibration) return std::optional<NewFoundCalibration>();
  const Result<Instrument> instrument = parse_instrument(texts->instrument, "the scan's instrument.toml");
  if (!instrument) return failure(instrument.error());
  const auto readings = reader.readings(scan, instrument->stage);
  if (!readings) return failure(readings.error());
  const Result<ScanInfo> info = reader.scan(scan);
  if (!info) return failure(info.error());
  Result<ModelOfVersions> chosen = model_of(brdf, reader, *instrument, *readings);
  if (!chosen) return failure(chosen.error());
  const api::PlanCalibration& wanted = *plan->calibration;
  Result<FoundValues> found = api::makes_maps(wanted.job)
                                  ? map_values_of(reader, scan, *instrument, wanted.job)
                                  : fitted(wanted, *readings, *instrument, chosen->model, brdf, info->reference_serial);
  if (!found) return failure(found.error());
  return std::optional(
      NewFoundCalibration{.scan = scan,
                          .job = std::string(calibration_job_name(plan->calibration->job)),
                          .code_version = std::string(kJobCode),
                          .inputs_json = inputs_of(scan, *texts, *instrument, *readings, chosen->versions),
                          .found = std::move(*found)});
}

NewEvent event_found(const NewFoundCalibration& found) {
  return {.kind = "calibration-found",
          .scan = found.scan,
          .who = "goniod",
          .json = nlohmann::json{{"job", found.job}, {"note", found.found.note}}.dump()};
}

Result<api::ChartReport> chart_of(StoreReader& reader, const std::string& standard) {
  const Result<std::vector<FoundCalibration>> all = reader.found_calibrations();
  if (!all) return failure(all.error());
  const std::map<ScanId, FoundCalibration> runs = runs_of(*all, standard);
  if (runs.empty()) {
    return failure({.code = ErrorCode::NotFound,
                    .device = "check standard",
                    .tried = "chart the runs of \"" + standard + "\"",
                    .seen = "it has none",
                    .limit = "a plan with [calibration] job = \"check-standard\" on this sample"});
  }
  std::vector<calibration::ChartRun> values;
  for (const auto& [scan, run] : runs) {
    values.push_back({.value = value_of(run.found, kMeanReff), .u_own = value_of(run.found, kOwnU)});
  }
  const calibration::ControlChart chart = calibration::control_chart(values);
  api::ChartReport report{.standard = standard,
                          .quantity = "mean REFF of the plan's points",
                          .baseline = static_cast<std::int64_t>(chart.baseline),
                          .centre = chart.centre,
                          .sd = chart.sd,
                          .low = chart.low(),
                          .high = chart.high(),
                          .verdict = verdict_of(chart)};
  auto judged = chart.runs.begin();
  auto value = values.begin();
  for (const auto& [scan, run] : runs) {
    report.points.push_back({.scan = scan,
                             .version = run.version,
                             .utc = iso8601(run.at),
                             .value = value->value,
                             .u = value->u_own,
                             .deviation = judged->deviation,
                             .broken = calibration::broken_rules_text(judged->broken)});
    ++judged;
    ++value;
  }
  return report;
}

}  // namespace gonio::daemon
