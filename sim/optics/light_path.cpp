#include "sim/optics/light_path.h"

#include <cmath>
#include <numbers>

namespace gonio::sim {

using stage::Axis;
using stage::index_of;

Station LightPath::station(double carriage_mm) const {
  constexpr double kWithinMm = 1.0;  // the field of view is still on the same target
  const auto at = [&](double place) { return std::abs(carriage_mm - place) <= kWithinMm; };
  if (at(scene_.stage.sample_mm)) return Station::Sample;
  if (at(scene_.stage.reference_mm)) return Station::Reference;
  return at(scene_.stage.trap_mm) ? Station::Trap : Station::Between;
}

const FilterSpec* LightPath::filter_at(double slot) const {
  constexpr double kWithinSlots = 0.1;
  for (const FilterSpec& filter : scene_.filters) {
    if (std::abs(slot - filter.slot) <= kWithinSlots) return &filter;
  }
  return nullptr;
}

Geometry LightPath::true_geometry(const StagePose& pose) const {
  const auto angle = [&](Axis axis) {
    return degrees(pose.positions[index_of(axis)]) + truth_.zero_error(axis) +
           truth_.repeat_error(axis, pose.last_moves[index_of(axis)]);
  };
  return {.theta_i = angle(Axis::ThetaI),
          .phi_i = angle(Axis::PhiI),
          .theta_r = angle(Axis::ThetaR),
          .phi_r = angle(Axis::PhiR)};
}

double LightPath::electron_rate(const StagePose& pose) const {
  if (!pose.source_open || !pose.detector_open) return 0.0;
  const Station target = station(pose.positions[index_of(Axis::Carriage)]);
  if (target == Station::Between || target == Station::Trap) return 0.0;
  const FilterSpec* filter = filter_at(pose.positions[index_of(Axis::FilterWheel)]);
  if (filter == nullptr) return 0.0;
  constexpr Angle kHorizon = degrees(90.0);
  const Geometry g = folded(true_geometry(pose));
  if (g.theta_i >= kHorizon || g.theta_r >= kHorizon) return 0.0;
  const Brdf f = target == Station::Sample ? truth_.sample(g) : truth_.reference(g, filter->centroid);
  const double reff = std::numbers::pi * f.si();
  return scene_.detector.electrons_per_s * filter->transmission * reff * std::cos(g.theta_i.si()) *
         truth_.placing(pose.last_move);
}

}  // namespace gonio::sim
