#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/geometry.h"
#include "calibration/frame_reducer.h"
#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "sim/devices/reading_level.h"
#include "sim/scene/chance.h"
#include "sim/scene/scene.h"

namespace gonio::coverage {

/// What looks at the sample.
enum class DetectorKind : std::uint8_t {
  Statistics,  ///< a camera: the statistics of its aperture are drawn
  Frames,      ///< a camera: every pixel is drawn, and the frame goes through the frame reducer
  Radiometer,  ///< a power meter with ranges
};

/// The power meter of `DetectorKind::Radiometer`: its errors are drawn here, from what `PowerModel` states.
struct MeterSpec {
  double w_per_electron_rate = 1e-9;  ///< W for one electron a second of the scene's camera
  std::vector<double> ranges_w = {1e-7, 1e-6, 1e-5, 1e-4, 1e-3};
  double noise = 2e-3;    ///< of one average, of the range's full scale
  double u_range = 1e-3;  ///< of each range's gain
  double u_zero = 1e-4;   ///< of full scale: wander between two darks
  double u_linearity = 1e-3;
  int samples = 10;
  double average_s = 0.003;
};

/// What a scan of the harness is made of.
struct ScanPlan {
  std::vector<double> theta_i_deg = {0.0, 30.0, 60.0};
  std::vector<double> theta_r_deg = {0.0, 15.0, 30.0, 45.0, 60.0, 75.0};
  std::vector<double> phi_r_deg = {0.0, 60.0, 120.0, 180.0};
  Wavelength wavelength = nanometres(568.0);
  std::size_t block = 16;   ///< sample items before their reference partners
  int frames = 2;           ///< of one reading
  int dark_frames = 2;      ///< of one visit and exposure
  double exposure_s = 0.0;  ///< stated; 0: a probe chooses it
  DetectorKind detector = DetectorKind::Statistics;
  MeterSpec meter;
  /// What interpolation between two darks misses: drawn once an interval.
  double u_dark_drift_dn_per_s = 0.0;
  /// Visits of the standard before the first block and after each, at 0/45 or as near to it as the points are.
  bool visits = false;
  bool ambient_visits = false;  ///< with the source's shutter closed, likewise
  bool trap_visits = false;     ///< of the black trap, likewise
  calibration::ReferenceMode reference_mode = calibration::ReferenceMode::SameGeometry;
  /// A monitor that shows 1, whatever the lamp does.
  bool monitor_is_blind = false;
  /// A step of the response, by this part, somewhere in each stretch between two visits, at a moment of its own.
  double step = 0.0;
};

/// A scan as the sequencer makes it, at reading level and in manual time: a dark visit with every exposure of the
/// ladder; blocks of sample items and then the same geometries on the reference, each item with a probe that chooses
/// its exposure; a dark visit after each block. The scene's time scale must be 1.
class ShortScan {
 public:
  /// The product of the lists for an isotropic sample: duplicates at the normal merged, retro directions in the shadow
  /// of the detector's head left out.
  [[nodiscard]] static std::vector<calibration::PlannedPoint> points_of(const ScanPlan& plan);
  /// What the daemon would be told of this instrument (as sim writes it into instrument.toml, in scene time).
  [[nodiscard]] static calibration::InstrumentModel stated_model(const sim::Scene& scene, const ScanPlan& plan);

  /// `points` must outlive it.
  ShortScan(const ScanPlan& plan, const std::vector<calibration::PlannedPoint>& points)
      : plan_(plan), points_(points) {}

  [[nodiscard]] calibration::ScanReadings measure(const sim::ReadingLevel& instrument);

 private:
  void draw_meter(std::uint64_t seed);
  void visit_dark(const sim::ReadingLevel& instrument);
  void visit_standard(const sim::ReadingLevel& instrument);
  void visit_stray(const sim::ReadingLevel& instrument);
  void visit_all(const sim::ReadingLevel& instrument);
  void read_item(const sim::ReadingLevel& instrument, const calibration::PlannedPoint& point,
                 calibration::Target target);
  void add_frames(const sim::ReadingLevel& instrument, const sim::ReadingRequest& request,
                  calibration::RawReading& reading);
  [[nodiscard]] double chosen_exposure_s(const sim::ReadingLevel& instrument, const sim::ReadingRequest& request);
  [[nodiscard]] std::size_t chosen_range(const sim::ReadingLevel& instrument, const sim::ReadingRequest& request);
  calibration::RawFrame expose(const sim::ReadingLevel& instrument, sim::ReadingRequest request, double exposure_s);
  calibration::RawFrame meter_power(const sim::ReadingLevel& instrument, sim::ReadingRequest request,
                                    std::size_t range);
  [[nodiscard]] calibration::RegionMoments statistics(const sim::ReadingLevel& instrument,
                                                      const sim::ReadingRequest& request);
  [[nodiscard]] sim::MonitorReading monitor(const sim::ReadingLevel& instrument, const sim::ReadingRequest& request);
  [[nodiscard]] double response() const;
  calibration::RawReading& begin(calibration::Target target);

  ScanPlan plan_;
  const std::vector<calibration::PlannedPoint>& points_;
  std::optional<calibration::FrameReducer> reducer_;
  calibration::ScanReadings scan_;
  double now_s_ = 0.0;
  sim::Chance chance_{0, sim::Purpose::Linearity};
  double dark_drift_dn_per_s_ = 0.0;
  std::vector<double> range_gains_;
  std::vector<double> range_zeros_;  ///< parts of full scale
  double meter_linearity_ = 0.0;
  double response_before_ = 1.0;
  double step_ = 0.0;
  double step_at_s_ = 0.0;
  std::uint64_t exposures_ = 0;
  std::uint64_t moves_ = 0;
};

}  // namespace gonio::coverage
