#include "sim/optics/light_path.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/optics/disc_overlap.h"

#include "sim/optics/turning_geometry.h"

namespace gonio::sim {

using reflectance::Direction;
using stage::Axis;
using stage::index_of;

namespace {

constexpr Angle kHorizon = degrees(90.0);

Angle encoder_error(const std::optional<PeriodicError>& error, Angle encoder) {
  if (!error) return {};
  return error->amplitude * std::sin(2.0 * std::numbers::pi * (encoder / error->period) + error->phase.si());
}

// SplitMix64's mixing (Steele, Lea and Flood 2014) of one more number into a key.
std::uint64_t with(std::uint64_t key, std::int64_t number) {
  std::uint64_t z = (key ^ static_cast<std::uint64_t>(number)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

}  // namespace

LightRate& LightRate::operator+=(const LightRate& other) {
  target += other.target;
  veil += other.veil;
  ambient += other.ambient;
  return *this;
}

LightPath::LightPath(const Scene& scene, const Truth& truth) : scene_(scene), truth_(truth) {
  if (scene.effects.polarisation) polarised_.emplace(*scene.effects.polarisation, scene.sample);
  if (scene.effects.stray && scene.effects.stray->internal_share != 0.0) reflected_.emplace(scene, truth);
}

Station LightPath::station(double carriage_mm) const {
  constexpr double kWithinMm = 1.0;  // the field of view is still on the same target
  const auto at = [&](double place) { return std::abs(carriage_mm - place) <= kWithinMm; };
  if (at(scene_.stage.sample_mm)) return Station::Sample;
  if (at(scene_.stage.reference_mm)) return Station::Reference;
  if (scene_.stage.open_mm && at(*scene_.stage.open_mm)) return Station::Open;
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
    const std::size_t a = index_of(axis);
    const Angle pointed = degrees(pose.positions[a] + pose.lags[a]) + truth_.zero_error(axis) +
                          truth_.repeat_error(axis, pose.last_moves[a]);
    return pointed + encoder_error(scene_.effects.encoder[a], degrees(pose.positions[a]));
  };
  if (const auto& sample = scene_.stage.turning_sample) {
    return directions_on(*sample, {.yaw = angle(sample->yaw),
                                   .pitch = angle(sample->pitch),
                                   .roll = angle(sample->roll),
                                   .detector_arm = angle(sample->detector_arm)});
  }
  return {.theta_i = angle(Axis::ThetaI),
          .phi_i = angle(Axis::PhiI),
          .theta_r = angle(Axis::ThetaR),
          .phi_r = angle(Axis::PhiR)};
}

std::uint64_t LightPath::place(const StagePose& pose) const {
  const SpeckleSpec& speckle = scene_.detector.speckle;
  if (speckle.contrast == 0.0) return 0;
  const auto target = station(pose.positions[index_of(Axis::Carriage)]);
  std::uint64_t key = with(0x9E3779B97F4A7C15ULL, static_cast<std::int64_t>(target));
  for (const Axis axis : {Axis::ThetaI, Axis::PhiI, Axis::ThetaR, Axis::PhiR})
    key = with(key, std::llround(degrees(pose.positions[index_of(axis)]) / speckle.cell));
  return key;
}

ConeAverage LightPath::seen(Station target, const Geometry& g, Wavelength wavelength) const {
  const auto f = [&](const Geometry& at) {
    return target == Station::Sample ? truth_.sample(at) : truth_.reference(at, wavelength);
  };
  const bool is_polarised = polarised_ && target == Station::Sample;
  if (!scene_.effects.cones && !is_polarised) return {.brdf = f(g), .mu_i = std::cos(g.theta_i.si()), .evaluations = 1};
  const auto axes = is_polarised ? polarisation_axes(*scene_.effects.polarisation, g) : PolarisationAxes{};
  const auto of_directions = [&](const Direction& i, const Direction& r) {
    return is_polarised ? polarised_->seen(i, r, axes) : f(reflectance::geometry_of(i, r));
  };
  return average_over_cones(scene_.effects.cones.value_or(ConeSpec{}), g, of_directions);
}

// The lit part of the field of view over what the whole field is: 1 where the field lies inside the spot, on the
// target.
double LightPath::overlap_factor(Station target, const MountedView& view) const {
  const OverlapSpec& spec = *scene_.effects.overlap;
  const Geometry& g = view.geometry;
  const Length field = spec.field_radius / view.detector_near;
  std::vector<SurfaceEllipse> discs{footprint(spec.spot_radius / view.source_near, g.theta_i, g.phi_i),
                                    footprint(field, g.theta_r, g.phi_r)};
  const auto put = [](SurfaceEllipse& disc, const SurfacePoint& at) {
    disc.centre_x_mm = in_millimetres(at.x);
    disc.centre_y_mm = in_millimetres(at.y);
  };
  put(discs[0], view.spot);
  put(discs[1], view.field);
  const auto& edge = target == Station::Sample ? spec.sample_radius : spec.reference_radius;
  if (edge) discs.push_back(footprint(*edge, {}, {}));
  const double whole_mm2 = std::numbers::pi * in_millimetres(field) * in_millimetres(field);
  return common_area_mm2(discs) * std::cos(g.theta_r.si()) / whole_mm2;
}

LightRate LightPath::rate(const StagePose& pose) const {
  const EffectsSpec& effects = scene_.effects;
  LightRate rate;
  if (!pose.detector_open) return rate;
  if (effects.stray) rate.ambient = effects.stray->ambient_electrons_per_s;
  const FilterSpec* filter = filter_at(pose.positions[index_of(Axis::FilterWheel)]);
  if (!pose.source_open || filter == nullptr) return rate;
  const double white = scene_.detector.electrons_per_s * filter->transmission * truth_.attenuation(*filter);
  if (effects.stray) rate.veil = white * effects.stray->source_share;
  const Station target = station(pose.positions[index_of(Axis::Carriage)]);
  if (target == Station::Open && effects.stop) {
    rate.target = white * direct_light(stop(), *effects.overlap, true_geometry(pose));
  }
  if (target != Station::Sample && target != Station::Reference) return rate;

  MountedView view{.geometry = folded(true_geometry(pose))};
  if (effects.mounting) {
    if (view.geometry.theta_i >= kHorizon || view.geometry.theta_r >= kHorizon) return rate;
    const MountSpec& mount = target == Station::Sample ? effects.mounting->sample : effects.mounting->reference;
    view = view_on(mount, effects.mounting->source_distance, effects.mounting->detector_distance, view.geometry);
  }
  const Geometry& g = view.geometry;
  if (g.theta_i >= kHorizon || g.theta_r >= kHorizon) return rate;
  const ConeAverage light = seen(target, g, filter->centroid);
  rate.target = white * (std::numbers::pi * light.brdf.si()) * light.mu_i * truth_.placing(pose.last_move);
  if (effects.mounting) rate.target *= view.source_near * view.source_near;
  if (effects.overlap) rate.target *= overlap_factor(target, view);
  if (effects.stop) {
    rate.target *= stop_solid_angle(stop(), effects.overlap->spot_radius, g) / stop_solid_angle(stop(), {}, Geometry{});
  }
  if (reflected_) {
    const double share = target == Station::Sample ? reflected_->sample(g.theta_i) : reflected_->reference(g.theta_i);
    rate.veil += white * effects.stray->internal_share * share * light.mu_i;
  }
  return rate;
}

}  // namespace gonio::sim
