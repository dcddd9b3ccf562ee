#include "calibration/jobs/linearity_ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calibration/dark_history.h"
#include "calibration/jobs/least_squares.h"
#include "calibration/linearity.h"

namespace gonio::calibration {

namespace {

constexpr double kLeastSignal = 20.0;  // in its own noise: below, the logarithm bends
constexpr int kRounds = 12;            // of Gauss and Newton; four settle

Error no_ladder(std::string seen, std::string limit) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = "fit the linearity of a ladder",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

struct LadderFrame {
  std::size_t item = 0;
  std::size_t rung = 0;
  double net = 0.0;          // DN
  LinearityPowers powers{};  // over powers of full scale
  double exposure_s = 0.0;
  double monitor = 0.0;
  double u = 0.0;  // relative, random
};

// What is fitted, and where each of it stands among the parameters.
struct Ladder {
  std::vector<LadderFrame> frames;
  std::vector<double> u_dark_dn;  // by rung: prior
  std::size_t items = 0;
  std::size_t order = 0;
  double full_scale_dn = 1.0;
  double brightest_dn = 0.0;

  [[nodiscard]] std::size_t offset_place() const { return order; }
  [[nodiscard]] std::size_t dark_place(std::size_t rung) const { return order + 1 + rung; }
  [[nodiscard]] std::size_t item_place(std::size_t item) const { return order + 1 + u_dark_dn.size() + item; }
  [[nodiscard]] std::size_t parameters() const { return item_place(items); }
};

double u_of_level(const DarkLevel& dark, const DetectorModel& detector, double exposure_s) {
  const double before = dark.before == nullptr ? 0.0 : (1.0 - dark.weight_after) * dark.before->u_dn;
  const double after = dark.after == nullptr ? 0.0 : dark.weight_after * dark.after->u_dn;
  return std::hypot(before, after, dark.drift_widening * detector.u_dark_drift_dn_per_s * exposure_s);
}

class LadderCollector {
 public:
  LadderCollector(const ScanReadings& scan, const DetectorModel& detector, std::size_t order)
      : scan_(scan), detector_(detector), darks_(scan, detector) {
    ladder_.order = order;
    ladder_.full_scale_dn = detector.full_scale_dn;
  }

  Result<Ladder> collect() {
    for (const RawReading& reading : scan_.readings) {
      if (!reading.point_index) continue;
      for (const RawFrame& frame : reading.frames) GONIO_TRY(add(reading, frame));
    }
    ladder_.items = items_.size();
    const std::size_t needed = ladder_.order + 3;
    if (exposures_.size() >= needed) return std::move(ladder_);
    return failure(
        no_ladder(fmt::format("{} exposures that were neither saturated nor too dark", exposures_.size()),
                  fmt::format("{} for a polynomial of order {} and an exposure offset", needed, ladder_.order)));
  }

 private:
  Result<void> add(const RawReading& reading, const RawFrame& frame) {
    if (frame.power) return failure(no_ladder("readings of a radiometer", "a camera's"));
    if (frame.reduced) return failure(no_ladder("frames reduced by maps", "frames as they came"));
    const std::optional<DarkLevel> dark = darks_.at(rung_of(frame), reading.at);
    if (!dark || frame.region.saturated > 0 || !(frame.monitor_mean > 0.0)) return {};
    LadderFrame one{.net = frame.region.mean - dark->level_dn,
                    .exposure_s = frame.exposure_s,
                    .monitor = frame.monitor_mean * std::pow(10.0, frame.gain_db / 20.0)};
    const double shot = std::max(0.0, one.net) / detector_.electrons_per_dn;
    const double noise = std::sqrt((dark->pixel_variance_dn2 + shot) / frame.region.n);
    if (one.net < kLeastSignal * noise) return {};
    one.powers = linearity_powers(one.net, detector_.full_scale_dn, &frame.region);
    one.u = std::hypot(noise / one.net, frame.monitor_se / frame.monitor_mean, detector_.u_monitor_window);
    one.item = items_.try_emplace(reading.visit_id, items_.size()).first->second;
    const auto [rung, is_new] = exposures_.try_emplace(rung_of(frame), exposures_.size());
    one.rung = rung->second;
    if (is_new) ladder_.u_dark_dn.push_back(0.0);
    double& u_dark = ladder_.u_dark_dn[one.rung];
    u_dark = std::max(u_dark, u_of_level(*dark, detector_, one.exposure_s));
    ladder_.brightest_dn = std::max(ladder_.brightest_dn, one.net);
    ladder_.frames.push_back(one);
    return {};
  }

  const ScanReadings& scan_;
  const DetectorModel& detector_;
  const DarkHistory darks_;
  Ladder ladder_;
  std::map<std::int64_t, std::size_t> items_;
  std::map<ExposureRung, std::size_t> exposures_;
};

std::vector<double> first_guess(const Ladder& ladder) {
  std::vector<double> guess(ladder.parameters(), 0.0);
  std::vector<double> weights(ladder.items, 0.0);
  for (const LadderFrame& frame : ladder.frames) {
    const double weight = 1.0 / (frame.u * frame.u);
    guess[ladder.item_place(frame.item)] += weight * std::log(frame.net / (frame.exposure_s * frame.monitor));
    weights[frame.item] += weight;
  }
  for (std::size_t item = 0; item < ladder.items; ++item) guess[ladder.item_place(item)] /= weights[item];
  return guess;
}

void add_frame(LeastSquares& squares, const Ladder& ladder, const LadderFrame& frame, const std::vector<double>& at) {
  const double dark_error = at[ladder.dark_place(frame.rung)];
  double light = frame.net - dark_error;
  double by_dark = 1.0;
  std::vector<std::size_t> places;
  std::vector<double> slopes;
  for (std::size_t k = 0; k < ladder.order; ++k) {
    light += at[k] * frame.powers[k];
    by_dark += at[k] * static_cast<double>(k + 2) * frame.powers[k] / frame.net;
    places.push_back(k);
    slopes.push_back(frame.powers[k]);
  }
  for (double& slope : slopes) slope /= light * frame.u;
  const double open_s = frame.exposure_s + at[ladder.offset_place()];
  const double residual = std::log(light / (open_s * frame.monitor)) - at[ladder.item_place(frame.item)];
  places.insert(places.end(), {ladder.offset_place(), ladder.dark_place(frame.rung), ladder.item_place(frame.item)});
  slopes.insert(slopes.end(), {-1.0 / (open_s * frame.u), -by_dark / (light * frame.u), -1.0 / frame.u});
  squares.add(-residual / frame.u, places, slopes);
}

LeastSquares squares_at(const Ladder& ladder, const std::vector<double>& at) {
  LeastSquares squares(ladder.parameters());
  for (const LadderFrame& frame : ladder.frames) add_frame(squares, ladder, frame, at);
  for (std::size_t rung = 0; rung < ladder.u_dark_dn.size(); ++rung) {
    constexpr double kSurelyKnown = 1e-6;  // DN
    const double u = std::max(kSurelyKnown, ladder.u_dark_dn[rung]);
    const std::size_t place = ladder.dark_place(rung);
    const double slope = 1.0 / u;
    squares.add(-at[place] / u, std::span(&place, 1), std::span(&slope, 1));
  }
  return squares;
}

FoundValues found_from(const Ladder& ladder, const std::vector<double>& at, const std::vector<double>& covariance,
                       double squares) {
  FoundValues found;
  for (std::size_t k = 0; k < ladder.order; ++k) {
    found.values.push_back({.name = fmt::format("linearity_{}", k + 1), .unit = "1", .value = at[k]});
  }
  found.values.push_back({.name = "exposure_offset_s", .unit = "s", .value = at[ladder.offset_place()]});
  // Each rung's dark has a parameter and a row: they take nothing from the degrees of freedom.
  const double dof = static_cast<double>(ladder.frames.size()) - static_cast<double>(ladder.items + ladder.order + 1);
  const double ratio = dof > 0.0 ? squares / dof : 1.0;
  const double widened = std::max(1.0, ratio);
  for (std::size_t a = 0; a <= ladder.order; ++a) {
    for (std::size_t b = 0; b <= ladder.order; ++b) {
      found.covariance.push_back(widened * covariance[a * ladder.parameters() + b]);
    }
  }
  found.note = fmt::format(
      "{} frames of {} items at {} exposures, up to {:.0f} % of full scale; chi-square {:.2f} a degree of freedom{}",
      ladder.frames.size(), ladder.items, ladder.u_dark_dn.size(), 100.0 * ladder.brightest_dn / ladder.full_scale_dn,
      ratio, ratio > 1.0 ? fmt::format(", so u is larger by {:.2f}", std::sqrt(widened)) : "");
  return found;
}

}  // namespace

Result<FoundValues> fit_linearity(const ScanReadings& scan, const InstrumentModel& instrument,
                                  const LadderOptions& options) {
  const auto order = static_cast<std::size_t>(std::clamp(options.order, 1, 3));
  const Result<Ladder> ladder = LadderCollector(scan, instrument.detector, order).collect();
  if (!ladder) return failure(ladder.error());
  std::vector<double> at = first_guess(*ladder);
  Result<LeastSquares::Step> step = squares_at(*ladder, at).solve();
  for (int round = 0; round < kRounds && step; ++round) {
    for (std::size_t k = 0; k < at.size(); ++k) at[k] += step->change[k];
    step = squares_at(*ladder, at).solve();
  }
  if (!step) return failure(step.error());
  return found_from(*ladder, at, step->covariance, squares_at(*ladder, at).sum_of_squares());
}

}  // namespace gonio::calibration
