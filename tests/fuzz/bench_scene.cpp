#include "tests/fuzz/bench_scene.h"

#include "protocol/stage/register_map.h"
#include "reflectance/surface/make_surface.h"

namespace gonio::fuzz {

sim::Scene bench_scene() {
  sim::Scene scene;
  scene.name = "fuzz";
  scene.draws_errors = false;
  scene.sample.push_back({.surface = *reflectance::make_surface("lambertian", {{"rho", 0.5}}), .weight = 1.0});
  scene.reference.certificate.push_back({.wavelength = nanometres(568.0), .reflectance = 0.99, .uncertainty = 0.005});
  scene.detector.width_px = 16;
  scene.detector.height_px = 16;
  scene.detector.spot_radius_px = 6.0;
  scene.detector.aperture_radius_px = 4.0;
  scene.detector.electrons_per_s = 1000.0;
  scene.stage.registers = stage::own_register_map();
  const sim::AxisSpec arm{
      .low = 0.0, .high = 85.0, .speed = 20.0, .acceleration = 40.0, .settle_s = 0.1, .window = 0.01};
  const sim::AxisSpec azimuth{
      .low = -185.0, .high = 365.0, .speed = 40.0, .acceleration = 80.0, .settle_s = 0.1, .window = 0.01};
  scene.stage.axes = {arm,
                      arm,
                      azimuth,
                      azimuth,
                      sim::AxisSpec{.low = 0.0, .high = 250.0, .speed = 100.0, .acceleration = 200.0, .window = 0.05},
                      sim::AxisSpec{.low = 1.0, .high = 4.0, .speed = 2.0, .acceleration = 8.0, .window = 0.01}};
  scene.filters.push_back({.slot = 1, .centroid = nanometres(568.0), .fwhm = nanometres(10.0)});
  return scene;
}

}  // namespace gonio::fuzz
