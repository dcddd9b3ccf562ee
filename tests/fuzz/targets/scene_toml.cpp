// Scenes of the simulator: the daemon takes the instrument and the reference that a scene describes.
#include <cmath>
#include <fstream>

#include "sim/scene/papers.h"
#include "sim/scene/read_scene.h"
#include "sim/scene/truth.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"
#include "tests/support/temporary_folder.h"

namespace gonio::fuzz {

void scene_toml(Bytes input) {
  static const test::TemporaryFolder folder(test::folder_in_memory());
  const std::string path = folder / "scene.toml";
  const std::string_view text = text_of(input);
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
  const auto scene = sim::read_scene(path);
  if (!scene) {
    hold_error(scene.error());
    return;
  }
  hold(std::isfinite(scene->time_scale) && scene->time_scale > 0.0, "time passes");
  hold(!scene->sample.empty() && !scene->reference.certificate.empty(), "there is a sample and a reference");
  const sim::Truth truth(*scene);
  hold(!sim::instrument_toml(*scene, {}).empty() && !sim::reference_toml(scene->reference).empty(),
       "a scene has papers");
}

}  // namespace gonio::fuzz
