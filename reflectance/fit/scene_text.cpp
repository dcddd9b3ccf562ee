#include "reflectance/fit/scene_text.h"

#include <algorithm>

#include <fmt/format.h>

#include "reflectance/surface/make_surface.h"

namespace gonio::fit {
namespace {

Result<std::string> model_lines(const reflectance::Surface& surface) {
  const auto known = reflectance::surface_models();
  if (std::ranges::find(known, surface.model(), &reflectance::ModelSpec::name) == known.end()) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "write a surface as a scene",
                    .seen = fmt::format("a surface \"{}\"", surface.model()),
                    .limit = "a model that scenes know by name; a table goes into a file that the scene names"});
  }
  std::string lines = fmt::format("model = \"{}\"\n", surface.model());
  for (const reflectance::NamedNumber& p : surface.parameters()) {
    std::string number = fmt::format("{}", p.value);
    if (number.find_first_of(".en") == std::string::npos) number += ".0";
    lines += fmt::format("{} = {}\n", p.name, number);
  }
  return lines;
}

}  // namespace

Result<std::string> scene_sample(const reflectance::Surface& surface) {
  if (surface.terms().empty()) {
    Result<std::string> lines = model_lines(surface);
    if (!lines) return lines;
    return "[sample]\n" + *lines;
  }
  std::string text = "[sample]\n";
  for (const reflectance::SurfaceTerm& term : surface.terms()) {
    Result<std::string> lines = model_lines(term.surface);
    if (!lines) return lines;
    text += fmt::format("[[sample.terms]]\nweight = {}\n{}", term.weight, *lines);
  }
  return text;
}

}  // namespace gonio::fit
