#pragma once

#include <cstdint>
#include <vector>

#include "base/geometry.h"
#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "sim/devices/reading_level.h"
#include "sim/scene/chance.h"
#include "sim/scene/scene.h"

namespace gonio::coverage {

/// A scan as the sequencer makes it, at reading level and in manual time: a dark visit with every exposure of the
/// ladder; blocks of sample items and then the same geometries on the reference, each item with a probe that chooses
/// its exposure; a dark visit after each block. The scene's time scale must be 1.
class ShortScan {
 public:
  struct Plan {
    std::vector<double> theta_i_deg;
    std::vector<double> theta_r_deg;
    std::vector<double> phi_r_deg;
    Wavelength wavelength = nanometres(568.0);
    std::size_t block = 16;  ///< sample items before their reference partners
    int frames = 2;          ///< of one reading
    int dark_frames = 2;     ///< of one visit and exposure
    /// Errors that the simulator does not have, drawn here once a scan and once an interval between darks.
    double u_exposure_offset_s = 0.0;
    double u_dark_drift_dn_per_s = 0.0;
  };

  /// The product of the lists for an isotropic sample: duplicates at the normal merged, retro directions in the shadow
  /// of the detector's head left out.
  [[nodiscard]] static std::vector<calibration::PlannedPoint> points_of(const Plan& plan);

  ShortScan(const Plan& plan, const std::vector<calibration::PlannedPoint>& points) : plan_(plan), points_(points) {}
  /// What the daemon would be told of this instrument (as sim writes it into instrument.toml, in scene time).
  [[nodiscard]] calibration::InstrumentModel stated_model(const sim::Scene& scene) const;

  [[nodiscard]] calibration::ScanReadings measure(const sim::ReadingLevel& instrument);

 private:
  void visit_dark(const sim::ReadingLevel& instrument);
  void read_item(const sim::ReadingLevel& instrument, const calibration::PlannedPoint& point,
                 calibration::Target target);
  [[nodiscard]] double chosen_exposure_s(const sim::ReadingLevel& instrument, sim::ReadingRequest request);
  calibration::RawFrame expose(const sim::ReadingLevel& instrument, sim::ReadingRequest request, double exposure_s);
  calibration::RawReading& begin(calibration::Target target);

  Plan plan_;
  std::vector<calibration::PlannedPoint> points_;
  calibration::ScanReadings scan_;
  double now_s_ = 0.0;
  sim::Chance chance_{0, sim::Purpose::Linearity};
  double exposure_offset_s_ = 0.0;
  double dark_drift_dn_per_s_ = 0.0;
  std::uint64_t exposures_ = 0;
  std::uint64_t moves_ = 0;
};

}  // namespace gonio::coverage
