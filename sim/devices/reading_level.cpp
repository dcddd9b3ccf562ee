#include "sim/devices/reading_level.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace gonio::sim {

using stage::Axis;
using stage::index_of;

namespace {

double carriage_of(const StageSpec& spec, Station station) {
  switch (station) {
    case Station::Sample:
      return spec.sample_mm;
    case Station::Reference:
      return spec.reference_mm;
    case Station::Trap:
      return spec.trap_mm;
    case Station::Open:
      return spec.open_mm.value_or(spec.trap_mm);
    case Station::Between:
      break;
  }
  return 0.5 * (spec.sample_mm + spec.reference_mm);
}

// The nearest filter; into the source the nearest with an attenuator.
double slot_of(const Scene& scene, Wavelength wavelength, Station target) {
  const auto distance = [&](const FilterSpec& f) {
    const bool is_wanted = f.attenuation.has_value() == (target == Station::Open);
    return std::pair(!is_wanted, std::abs((f.centroid - wavelength).si()));
  };
  return std::ranges::min_element(scene.filters, {}, distance)->slot;
}

}  // namespace

ReadingLevel::ReadingLevel(Scene scene)
    : scene_(std::move(scene)), truth_(scene_), lamp_(scene_), light_path_(scene_, truth_), charge_(scene_, truth_) {}

Exposure ReadingLevel::expose(const ReadingRequest& request) const {
  assert(request.exposure > Duration::zero());
  StagePose pose{.last_move = request.move, .source_open = !request.is_ambient, .detector_open = !request.is_dark};
  pose.positions[index_of(Axis::ThetaI)] = in_degrees(request.encoders.theta_i);
  pose.positions[index_of(Axis::ThetaR)] = in_degrees(request.encoders.theta_r);
  pose.positions[index_of(Axis::PhiR)] = in_degrees(request.encoders.phi_r);
  pose.positions[index_of(Axis::PhiI)] = in_degrees(request.encoders.phi_i);
  pose.positions[index_of(Axis::Carriage)] = carriage_of(scene_.stage, request.target);
  pose.positions[index_of(Axis::FilterWheel)] = slot_of(scene_, request.wavelength, request.target);
  pose.last_moves.fill(request.move);
  for (const Axis axis : stage::kAllAxes) {
    const double half_play = 0.5 * scene_.stage.axes[index_of(axis)].backlash;
    pose.lags[index_of(axis)] = request.approach == Approach::FromBelow ? -half_play : half_play;
  }

  const double length_s = scene_.scene_seconds(request.exposure);
  const double to_s = request.at_scene_s + length_s;
  const double lamp = request.is_dark ? 1.0 : lamp_.mean(request.at_scene_s, to_s);  // behind the shutter none counts
  Exposure exposure = charge_.collect(light_path_.rate(pose) * length_s, lamp, request.at_scene_s, length_s);
  exposure.number = request.exposure_number;
  exposure.place = light_path_.place(pose);
  return exposure;
}

MonitorReading ReadingLevel::monitor(const ReadingRequest& request) const {
  const double to_s = request.at_scene_s + scene_.scene_seconds(request.exposure);
  return lamp_.monitor(request.at_scene_s, to_s, request.exposure_number);
}

ReadingAnswer ReadingLevel::read(const ReadingRequest& request) const {
  return {.region = draw_region(scene_.detector, expose(request), scene_.seed), .monitor = monitor(request)};
}

}  // namespace gonio::sim
