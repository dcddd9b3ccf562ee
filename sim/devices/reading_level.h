#pragma once

#include <cstdint>

#include "base/clock.h"
#include "base/geometry.h"
#include "sim/devices/detector_charge.h"
#include "sim/devices/detector_noise.h"
#include "sim/optics/lamp.h"
#include "sim/optics/light_path.h"
#include "sim/scene/scene.h"
#include "sim/scene/truth.h"

namespace gonio::sim {

/// From which side the arms have come to where they stand, for backlash.
enum class Approach : std::uint8_t { FromBelow, FromAbove };

/// One exposure to be made with everything at rest.
struct ReadingRequest {
  Station target = Station::Sample;
  bool is_dark = false;     ///< detector shutter closed
  bool is_ambient = false;  ///< source shutter closed
  Geometry encoders;        ///< what the encoders say; the truth adds its errors
  Wavelength wavelength;    ///< of a filter of the scene: the nearest is taken (into the source, with an attenuator)
  Duration exposure{};      ///< wall time
  double at_scene_s = 0.0;  ///< when it opens, in scene seconds from the start
  std::uint64_t move = 1;   ///< which move brought the stage there: the key of repeat error and placing
  std::uint64_t exposure_number = 1;  ///< the key of its noise: each its own
  Approach approach = Approach::FromBelow;
};

struct ReadingAnswer {
  RegionStatistics region;
  MonitorReading monitor;
};

/// Readings without a stage, wires or frames: the same truth, lamp, effects and noise as `Instrument` and `CameraModel`
/// give, for runs of many repetitions. Immutable; threads: any.
class ReadingLevel {
 public:
  explicit ReadingLevel(Scene scene);
  ReadingLevel(const ReadingLevel&) = delete;
  ReadingLevel& operator=(const ReadingLevel&) = delete;

  [[nodiscard]] ReadingAnswer read(const ReadingRequest& request) const;
  /// What `read` draws its statistics from: the charge of the exposure before any noise, as `render_frame` takes it.
  [[nodiscard]] Exposure expose(const ReadingRequest& request) const;
  /// The monitor over the same stretch as the exposure.
  [[nodiscard]] MonitorReading monitor(const ReadingRequest& request) const;
  [[nodiscard]] const Truth& truth() const { return truth_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
  Truth truth_;
  Lamp lamp_;
  LightPath light_path_;
  DetectorCharge charge_;
};

}  // namespace gonio::sim
