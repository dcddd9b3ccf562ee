#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "calibration/raw_reading.h"
#include "daemon/config/instrument.h"

namespace gonio::daemon {

/// A rung of the exposure ladder, and how many frames on it.
struct ExposurePlan {
  std::size_t rung = 0;
  int frames = 1;
  friend bool operator==(const ExposurePlan&, const ExposurePlan&) = default;
};

/// What a plan asks of a reading.
struct ReadingLimits {
  double target_snr = 300.0;
  Duration max_time{};
  std::vector<Duration> exposures{};  ///< ascending; empty: chosen
};

/// Chooses exposures and frame counts from the photon-transfer model of the detector (EMVA 1288): the cheapest rung
/// that reaches the plan's signal-to-noise within its time, well below full scale; if none does, the one that comes
/// nearest. A radiometer's rungs are its ranges, the largest first, and its unit is the part of a range instead of the
/// DN. It learns the dark levels from dark visits, the signal from what was measured last, the time of a frame
/// from frames.
class ExposureChooser {
 public:
  ExposureChooser(const Instrument& instrument, const ReadingLimits& limits);

  /// shortest * 2^n, up to the longest that the detector and the plan's max_time allow; never empty.
  [[nodiscard]] const std::vector<Duration>& rungs() const { return rungs_; }
  /// The rungs that the plan states, ascending: every reading uses them, as far as they do not saturate. Empty: chosen.
  [[nodiscard]] const std::vector<std::size_t>& stated() const { return stated_; }

  /// Of a rung of a radiometer, its full scale; nothing for a camera.
  [[nodiscard]] std::optional<double> range_w(std::size_t rung) const;
  /// What a signal is multiplied by for the level on a rung: the exposure in s; of a radiometer 1 / full scale in W.
  [[nodiscard]] double weight(std::size_t rung) const { return weights_[rung]; }

  /// Signal (DN above dark) per second of exposure, as the mean in the aperture; of a radiometer the power in W.
  struct Signal {
    double rate_dn_per_s = 0.0;
    std::uint32_t pixels = 1;
  };
  /// Of a frame's net mean over `pixels`, in DN^2 (EMVA 1288): shot noise, and read noise twice because a dark is
  /// subtracted.
  [[nodiscard]] double frame_variance(double net_dn, std::uint32_t pixels) const;
  /// What it knows, for a reading that is to reach `target_snr`; always on `rung`, where one is given and the plan
  /// states none.
  [[nodiscard]] ExposureChooser for_visit(double target_snr, std::optional<std::size_t> rung) const;
  /// `ceiling`: the highest rung that may be used (a higher one saturated).
  [[nodiscard]] ExposurePlan choose(const Signal& signal, std::size_t ceiling) const;
  /// How many frames on `rung` reach the plan's signal-to-noise: bounded by the plan's time and the instrument.
  [[nodiscard]] int frames_needed(std::size_t rung, const Signal& signal) const;
  /// The plan's, of all exposures of a reading.
  [[nodiscard]] Duration max_time() const { return max_time_; }
  [[nodiscard]] bool reaches(std::size_t rung, const Signal& signal) const;
  /// The time of a plan, frame transfer included.
  [[nodiscard]] Duration cost(const ExposurePlan& plan) const;

  /// For the first frame of an item: by the last signal of this target and filter, else a probe in the middle of the
  /// ladder.
  [[nodiscard]] ExposurePlan first_plan(calibration::Target target, int filter) const;
  [[nodiscard]] std::optional<Signal> last_signal(calibration::Target target, int filter) const;
  /// By how much, relative, signals change from item to item: twice the running mean, below 1.
  [[nodiscard]] double usual_change() const;
  /// Whether a signal will surely not saturate on a rung.
  [[nodiscard]] bool is_clear_of_full_scale(std::size_t rung, const Signal& signal) const;
  void remember(calibration::Target target, int filter, const Signal& signal);
  void learn_dark(std::size_t rung, double mean_dn) { dark_dn_[rung] = mean_dn; }
  /// The dark level of a rung; 0 before it was measured.
  [[nodiscard]] double dark_dn(std::size_t rung) const { return dark_dn_[rung]; }
  void learn_frame_time(Duration beyond_exposure);

  /// The plan's limits were changed: counts from the next choice on. Rungs that come up have no dark level yet; none
  /// goes away, but none beyond `max_time` is chosen any more. True when there are more rungs than before.
  bool change_limits(const DetectorConfig& detector, double target_snr, Duration max_time);

 private:
  [[nodiscard]] double frames_wished(std::size_t rung, const Signal& signal) const;
  [[nodiscard]] int frames_allowed(std::size_t rung) const;

  std::vector<Duration> rungs_;
  std::vector<double> weights_;
  std::vector<double> ranges_w_;  ///< of a radiometer, by rung
  std::vector<std::size_t> stated_;
  std::vector<double> dark_dn_;
  std::size_t top_ = 0;  ///< the highest rung that max_time_ allows
  std::map<std::pair<calibration::Target, int>, Signal> last_;
  double mean_change_;  ///< of signals, from item to item: |ln(ratio)|
  double target_snr_;
  Duration max_time_;
  int frames_at_most_;
  double electrons_per_dn_;
  double read_noise_dn_;
  double full_scale_dn_;
  Duration frame_time_;
};

}  // namespace gonio::daemon
