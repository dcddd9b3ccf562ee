#pragma once

#include <cstdint>
#include <optional>

#include "protocol/stage/axis.h"
#include "sim/optics/cone_average.h"
#include "sim/optics/direct_light.h"
#include "sim/optics/mounting.h"
#include "sim/optics/polarised_light.h"
#include "sim/optics/reflected_share.h"
#include "sim/scene/scene.h"
#include "sim/scene/truth.h"

namespace gonio::sim {

/// Where everything in the light's way stands at one instant: positions as the axes are (deg, mm, slot), without the
/// errors that only the truth knows.
struct StagePose {
  stage::PerAxis<double> positions{};          ///< of the motors, which have the encoders
  stage::PerAxis<double> lags{};               ///< what is moved stands so far from its motor: backlash
  stage::PerAxis<std::uint64_t> last_moves{};  ///< which move brought each axis there
  std::uint64_t last_move = 0;                 ///< of any axis
  bool source_open = false;
  bool detector_open = false;
};

/// What stands before the detector.
enum class Station : std::uint8_t { Between, Sample, Reference, Trap, Open };

/// Light on the detector, or its integral over time: electrons (per second of scene time), before nonlinearity.
struct LightRate {
  double target = 0.0;   ///< of one lit pixel, for lamp output 1: from the target into the field of view, or straight
                         ///< through
  double veil = 0.0;     ///< of every pixel, for lamp output 1: stray light of the source and of the detector's inside
  double ambient = 0.0;  ///< of every pixel, whatever the lamp gives
  LightRate& operator+=(const LightRate& other);
  friend LightRate operator*(const LightRate& rate, double k) {
    return {.target = rate.target * k, .veil = rate.veil * k, .ambient = rate.ambient * k};
  }
};

/// From the lamp to the detector. Without effects the field of view lies inside the lit spot, so the signal goes as f_r
/// cos(theta_i) (Mobley 2005, footnote 5) at the true angles; what the scene names of cones, overlap, mounting,
/// encoders, polarisation and stray light comes on top (sim/README.md). Immutable but for what it refers to; threads:
/// any.
class LightPath {
 public:
  /// Both must outlive it.
  LightPath(const Scene& scene, const Truth& truth);

  /// No light with a closed detector shutter; only the ambient with a closed source shutter, between carriage stations,
  /// or with either arm below the horizon, where source stray light passes too, as before the black trap; none of the
  /// lamp's between filters. At the open station the lamp itself, where the detector looks into it and the scene says
  /// what its stop takes in.
  [[nodiscard]] LightRate rate(const StagePose& pose) const;

  [[nodiscard]] Station station(double carriage_mm) const;
  /// Where the arms really point: the encoders' directions with backlash, the encoders' own errors, and the zero and
  /// repeat errors of the truth. In the frame of the bench: a mount may lean.
  [[nodiscard]] Geometry true_geometry(const StagePose& pose) const;
  /// The filter that stands in the light at this position of the wheel; null between filters.
  [[nodiscard]] const FilterSpec* filter_at(double slot) const;
  /// A number for the place that the pose looks at: target and encoder directions within a speckle's cell. 0 where the
  /// scene has no speckle.
  [[nodiscard]] std::uint64_t place(const StagePose& pose) const;

 private:
  [[nodiscard]] ConeAverage seen(Station target, const Geometry& g, Wavelength wavelength) const;
  [[nodiscard]] double overlap_factor(Station target, const MountedView& view) const;
  [[nodiscard]] Stop stop() const { return {.radius = truth_.stop_radius(), .distance = truth_.stop_distance()}; }

  const Scene& scene_;
  const Truth& truth_;
  std::optional<PolarisedSample> polarised_;
  std::optional<ReflectedShare> reflected_;
};

}  // namespace gonio::sim
