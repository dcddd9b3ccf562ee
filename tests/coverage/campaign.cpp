#include "tests/coverage/campaign.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

#include "calibration/calibrate.h"

namespace gonio::coverage {
namespace {

const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};

Result<RepetitionOutcome> repeat(const PreparedScene& prepared, const calibration::ReferenceStandard& standard,
                                 std::uint64_t seed, const std::optional<Correction>& left_out) {
  sim::Scene scene = prepared.base;
  scene.seed = seed;
  // A purpose of no draw of the simulator.
  sim::Chance chance(seed, static_cast<sim::Purpose>(1000));
  if (prepared.scene.draw) prepared.scene.draw(scene, chance);
  const sim::ReadingLevel instrument(std::move(scene));
  ShortScan short_scan(prepared.scene.plan, prepared.points);
  calibration::ScanReadings readings = short_scan.measure(instrument);
  if (left_out) leave_out(*left_out, readings);
  calibration::CalibrationOptions how;
  how.threads = 1;
  how.left_out.overlap = left_out == Correction::Overlap;
  how.left_out.cones = left_out == Correction::Cones;
  const auto scan = calibration::calibrate(readings, prepared.told, standard, kToday, how);
  if (!scan) return failure(scan.error());
  return outcome_of(*scan, instrument.truth(), prepared.points.size(), prepared.scene.has_lobe,
                    left_out != Correction::Correlation);
}

}  // namespace

Result<std::vector<RepetitionOutcome>> run_campaign(const PreparedScene& scene, const CampaignOptions& options) {
  PreparedScene prepared = scene;
  if (options.left_out) leave_out(*options.left_out, prepared);
  const calibration::ReferenceStandard standard(prepared.reference);
  std::vector<RepetitionOutcome> outcomes(static_cast<std::size_t>(options.repetitions));
  std::atomic<std::size_t> next = 0;
  std::mutex guard;
  std::optional<Error> first_error;
  const auto work = [&] {
    for (std::size_t n = next++; n < outcomes.size(); n = next++) {
      auto outcome = repeat(prepared, standard, prepared.scene.first_seed + n, options.left_out);
      if (outcome) {
        outcomes[n] = std::move(*outcome);
        continue;
      }
      const std::lock_guard lock(guard);
      if (!first_error) first_error = outcome.error();
      next = outcomes.size();
    }
  };
  std::vector<std::jthread> threads;
  for (int t = 1; t < options.threads; ++t) threads.emplace_back(work);
  work();
  threads.clear();  // joins
  if (first_error) return failure(*first_error);
  return outcomes;
}

}  // namespace gonio::coverage
