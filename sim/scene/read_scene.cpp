#include "sim/scene/read_scene.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/toml_reader.h"
#include "reflectance/surface/make_surface.h"
#include "sim/scene/read_faults.h"
#include "sim/scene/read_sections.h"
#include "sim/scene/read_surface_file.h"

namespace gonio::sim {
namespace {

// A measured surface: `file`, beside the scene.
std::optional<reflectance::SurfaceTerm> read_file_term(TomlReader& table, double weight) {
  const std::string name = table.text("file");
  const std::string channel = table.text_or("channel", "");
  if (table.has_failed()) return std::nullopt;
  const auto path = std::filesystem::path(table.file()).parent_path() / name;
  auto surface = surface_of_file(path.string(), channel);
  if (!surface) {
    table.fail("file", surface.error().code, describe(surface.error()), surface.error().limit);
    return std::nullopt;
  }
  return reflectance::SurfaceTerm{*std::move(surface), weight};
}

// The terms of [sample]: one model or file, or [[sample.terms]], each with a weight.
std::optional<reflectance::SurfaceTerm> read_term(TomlReader& table, bool has_weight) {
  const double weight = has_weight ? table.number("weight", {.least = 0.0}) : 1.0;
  if (table.kind("file") != TomlKind::Absent) return read_file_term(table, weight);
  const std::string model = table.text("model");
  reflectance::Parameters parameters;
  for (const std::string& key : table.keys()) {
    if (key == "model" || key == "weight") continue;
    parameters.push_back({.name = key, .value = table.number(key)});
  }
  if (table.has_failed()) return std::nullopt;
  auto surface = reflectance::make_surface(model, parameters);
  if (!surface) {
    const Error& error = surface.error();
    const std::string key = error.where ? error.where->field : "model";
    table.fail(key, error.code, error.seen, error.limit);
    return std::nullopt;
  }
  return reflectance::SurfaceTerm{*std::move(surface), weight};
}

void read_sample(TomlReader& root, Scene& scene) {
  TomlReader sample = root.table("sample");
  std::vector<TomlReader> tables = sample.tables("terms");
  const bool is_sum = !tables.empty();
  if (!is_sum) tables.push_back(sample);
  for (TomlReader& table : tables) {
    if (auto term = read_term(table, is_sum)) scene.sample.push_back(*std::move(term));
  }
}

std::string read_head(TomlReader& root, Scene& scene) {
  TomlReader head = root.table("scene");
  scene.name = head.text("name");
  scene.seed = static_cast<std::uint64_t>(head.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
  scene.time_scale = head.number_or("time_scale", 1.0, {.least = 0.001, .most = 1e6});
  scene.draws_errors = head.flag_or("draw_errors", true);
  return head.text_or("bench", "");
}

}  // namespace

Result<Scene> read_scene(const std::string& path) {
  auto root = TomlReader::parse_file(path);
  if (!root) return failure(std::move(root).error());
  Scene scene;
  const std::string bench_name = read_head(*root, scene);
  read_sample(*root, scene);
  std::optional<TomlReader> bench;
  if (!bench_name.empty()) {
    const auto bench_path = std::filesystem::path(path).parent_path() / bench_name;
    auto parsed = TomlReader::parse_file(bench_path.string());
    if (!parsed) return failure(std::move(parsed).error());
    bench = *std::move(parsed);
  }
  read_sections(*root, bench ? &*bench : nullptr, scene);
  scene.faults = read_faults(*root);
  GONIO_TRY(root->finish());
  if (bench) GONIO_TRY(bench->finish());
  return scene;
}

}  // namespace gonio::sim
