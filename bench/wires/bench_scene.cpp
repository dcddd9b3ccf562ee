#include "bench/wires/bench_scene.h"

#include "protocol/stage/register_map.h"
#include "reflectance/surface/make_surface.h"

namespace gonio::bench {

sim::Scene bench_scene(int side_px) {
  sim::Scene scene;
  scene.name = "wires";
  scene.draws_errors = false;
  scene.sample.push_back({.surface = *reflectance::make_surface("lambertian", {{"rho", 0.5}}), .weight = 1.0});
  scene.reference.certificate.push_back({.wavelength = nanometres(568.0), .reflectance = 0.99, .uncertainty = 0.005});
  scene.detector.width_px = side_px;
  scene.detector.height_px = side_px;
  scene.detector.electrons_per_s = 1.0;
  scene.detector.shortest_exposure_s = 1e-4;
  scene.stage.registers = stage::own_register_map();
  for (sim::AxisSpec& axis : scene.stage.axes) axis = {.low = 0.0, .high = 90.0, .speed = 10.0, .acceleration = 20.0};
  scene.filters.push_back({.slot = 1, .centroid = nanometres(568.0), .fwhm = nanometres(10.0)});
  return scene;
}

}  // namespace gonio::bench
