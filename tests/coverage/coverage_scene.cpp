#include "tests/coverage/coverage_scene.h"

#include "sim/scene/papers.h"
#include "sim/scene/read_scene.h"

namespace gonio::coverage {

Result<PreparedScene> prepare(const CoverageScene& scene, bool without_certificate) {
  auto base = sim::read_scene(std::string(GONIO_SCENES) + "/" + scene.file + ".toml");
  if (!base) return failure(base.error());
  base->time_scale = 1.0;
  base->detector.width_px = base->detector.height_px = 26;  // just the aperture: nothing looks at the rest
  if (scene.bend) scene.bend(*base);
  if (without_certificate) {
    for (auto& entry : base->reference.certificate) entry.uncertainty = 0.0;
  }
  auto reference = calibration::parse_reference(sim::reference_toml(base->reference), "reference.toml");
  if (!reference) return failure(reference.error());
  calibration::InstrumentModel told = ShortScan::stated_model(*base, scene.plan);
  if (scene.tell) scene.tell(told);
  return PreparedScene{.scene = scene,
                       .base = std::move(*base),
                       .points = ShortScan::points_of(scene.plan),
                       .told = told,
                       .reference = std::move(*reference)};
}

}  // namespace gonio::coverage
