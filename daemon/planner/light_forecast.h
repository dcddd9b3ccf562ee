#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "calibration/raw_reading.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/exposure_choice.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// How long a scan's readings will be exposed, before anything is measured. Known where the plan states exposures, the
/// detector is a radiometer, or the plan says about what the sample reflects and past scans of this instrument say what
/// it sees of the standard: then by the rule of the run (ExposureChooser). Else a guess, the geometric mean of the
/// shortest and the longest.
class LightForecast {
 public:
  LightForecast(const api::Plan& plan, const Instrument& instrument, const TimeExperience& experience);

  struct Light {
    Duration exposure{};  ///< of all frames
    int frames = 1;
    std::optional<std::size_t> lowest{};  ///< rung of it; none: a guess, or stated
    std::optional<std::size_t> highest{};
  };
  [[nodiscard]] Light of(const ScanPoint& point, calibration::Target target) const;
  /// Of a lit visit.
  [[nodiscard]] Light of_visit(const ScanPoint& point, calibration::Target target) const;
  /// Standard deviation of a reading's signal by its noise, relative; what `target_snr` says where nothing is known.
  [[nodiscard]] double relative_noise(const ScanPoint& point, calibration::Target target) const;

  [[nodiscard]] bool is_known(const ScanPoint& point) const { return !is_guess_ || signal_of(point, 1.0).has_value(); }
  [[nodiscard]] const std::vector<Duration>& rungs() const { return chooser_.rungs(); }
  /// Standard uncertainty of one exposure that is a guess: any between the shortest and the longest, evenly in their
  /// logarithm.
  [[nodiscard]] double u_guess_s() const;

 private:
  [[nodiscard]] std::optional<ExposureChooser::Signal> signal_of(const ScanPoint& point, double reflectance) const;
  [[nodiscard]] double reflectance_of(calibration::Target target) const;
  [[nodiscard]] Light by(const ExposureChooser& chooser, const ScanPoint& point, calibration::Target target) const;

  std::vector<WhiteSignal> white_;  ///< of the standard, as past scans saw it
  std::optional<double> expected_;
  double target_snr_;
  bool is_guess_;
  Light unknown_;  ///< a guess, or what is stated
  std::uint32_t pixels_;
  ExposureChooser chooser_;
  ExposureChooser visit_chooser_;
};

}  // namespace gonio::daemon
