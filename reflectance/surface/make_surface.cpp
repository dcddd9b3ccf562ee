#include "reflectance/surface/make_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "reflectance/surface/fresnel_mirror.h"
#include "reflectance/surface/ggx.h"
#include "reflectance/surface/glint.h"
#include "reflectance/surface/hapke.h"
#include "reflectance/surface/lambertian.h"
#include "reflectance/surface/minnaert.h"
#include "reflectance/surface/rpv.h"
#include "reflectance/surface/water_body.h"

namespace gonio::reflectance {
namespace {

using Values = std::span<const double>;  // in the order of the model's spec

struct Row {
  ModelSpec spec;
  Result<Surface> (*make)(Values);
};

template <class M>
Result<Surface> as_surface(Result<M> model) {
  if (!model) return failure(std::move(model).error());
  return Surface(*std::move(model));
}

template <HapkeForm form>
Result<Surface> make_hapke(Values v) {
  return as_surface(Hapke::make({.omega0 = v[0], .form = form, .g = v.size() > 1 ? v[1] : 0.0}));
}

template <RpvNorm norm>
Result<Surface> make_rpv(Values v) {
  return as_surface(Rpv::make({.rho0 = v[0], .k = v[1], .g = v[2], .norm = norm}));
}

template <Shadowing shadowing>
Result<Surface> make_glint(Values v) {
  return as_surface(Glint::make({.slope_variance = v[0], .refractive_index = v[1], .shadowing = shadowing}));
}

constexpr std::array kSea{
    ParameterSpec{
        .name = "wind_m_per_s", .least = 0.0, .most = 30.0, .unit = "m/s", .meaning = "wind at 12.5 m height"},
    ParameterSpec{.name = "refractive_index", .least = 1.0, .most = 4.0, .meaning = "of the water"},
};
constexpr ModelSpec kCoxMunk{"cox_munk", "glint of a sea under wind, no shadowing", kSea};
constexpr ModelSpec kCoxMunkSmith{"cox_munk_smith", "glint of a sea under wind, Smith shadowing", kSea};

template <Shadowing shadowing>
Result<Surface> make_cox_munk(Values v) {
  GONIO_TRY(check_values(shadowing == Shadowing::None ? kCoxMunk : kCoxMunkSmith, v));
  return make_glint<shadowing>(std::array{cox_munk_slope_variance(v[0]), v[1]});
}

constexpr ModelSpec kBeckmann{"beckmann", "facets with Gaussian slopes by their roughness, Smith shadowing",
                              kFacetParameters};

// alpha^2 is the variance of both slope components together; at the least of one the square rounds below that of the
// other.
Result<Surface> make_beckmann(Values v) {
  GONIO_TRY(check_values(kBeckmann, v));
  const double variance = std::max(1e-6, v[0] * v[0]);
  return make_glint<Shadowing::Smith>(std::array{variance, v[1]});
}

std::span<const Row> rows() {
  static const std::array kRows{
      Row{Lambertian::kSpec, [](Values v) { return as_surface(Lambertian::make({.rho = v[0]})); }},
      Row{Minnaert::kSpec, [](Values v) { return as_surface(Minnaert::make({.rho = v[0], .k = v[1]})); }},
      Row{Hapke::kSpec, make_hapke<HapkeForm::Hapke>},
      Row{Hapke::kSpecAsPrinted, make_hapke<HapkeForm::AsPrinted>},
      Row{Hapke::kSpecExact, make_hapke<HapkeForm::Exact>},
      Row{Hapke::kSpecHg, make_hapke<HapkeForm::Hapke>},
      Row{Hapke::kSpecExactHg, make_hapke<HapkeForm::Exact>},
      Row{Rpv::kSpec, make_rpv<RpvNorm::Brdf>},
      Row{Rpv::kSpecBrf, make_rpv<RpvNorm::Brf>},
      Row{FresnelMirror::kSpec, [](Values v) { return as_surface(FresnelMirror::make({.refractive_index = v[0]})); }},
      Row{WaterBody::kSpec,
          [](Values v) { return as_surface(WaterBody::make({.rho_w = v[0], .refractive_index = v[1]})); }},
      Row{kCoxMunk, make_cox_munk<Shadowing::None>},
      Row{kCoxMunkSmith, make_cox_munk<Shadowing::Smith>},
      Row{Glint::kSpec, make_glint<Shadowing::None>},
      Row{Glint::kSpecSmith, make_glint<Shadowing::Smith>},
      Row{kBeckmann, make_beckmann},
      Row{Ggx::kSpec, [](Values v) { return as_surface(Ggx::make({.roughness = v[0], .refractive_index = v[1]})); }},
  };
  return kRows;
}

template <class Range>
std::string names_of(const Range& named) {
  std::string text;
  for (const auto& item : named) text += (text.empty() ? "" : ", ") + std::string(item.name);
  return text;
}

Error parameter_error(ErrorCode code, const ModelSpec& model, std::string_view field, std::string seen) {
  return {.code = code,
          .tried = fmt::format("make a surface \"{}\"", model.name),
          .seen = std::move(seen),
          .limit = "its parameters are " + names_of(model.parameters),
          .where = InputLocation{.file = {}, .field = std::string(field)}};
}

// The values in the order of the spec, each given exactly once.
Result<std::vector<double>> ordered(const ModelSpec& model, const Parameters& parameters) {
  for (const NamedNumber& given : parameters) {
    if (std::ranges::find(model.parameters, given.name, &ParameterSpec::name) != model.parameters.end()) continue;
    return failure(parameter_error(ErrorCode::UnknownKey, model, given.name,
                                   fmt::format("there is no parameter \"{}\"", given.name)));
  }
  std::vector<double> values;
  for (const ParameterSpec& wanted : model.parameters) {
    const auto count = std::ranges::count(parameters, wanted.name, &NamedNumber::name);
    if (count == 0) {
      return failure(parameter_error(ErrorCode::MissingKey, model, wanted.name,
                                     fmt::format("parameter \"{}\" is missing", wanted.name)));
    }
    if (count > 1) {
      return failure(parameter_error(ErrorCode::InvalidInput, model, wanted.name,
                                     fmt::format("parameter \"{}\" is given {} times", wanted.name, count)));
    }
    values.push_back(std::ranges::find(parameters, wanted.name, &NamedNumber::name)->value);
  }
  return values;
}

}  // namespace

std::span<const ModelSpec> surface_models() {
  static const std::vector<ModelSpec> kSpecs = [] {
    std::vector<ModelSpec> specs;
    for (const Row& row : rows()) specs.push_back(row.spec);
    return specs;
  }();
  return kSpecs;
}

Result<Surface> make_surface(std::string_view model, const Parameters& parameters) {
  const auto row = std::ranges::find(rows(), model, [](const Row& r) { return r.spec.name; });
  if (row == rows().end()) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "make a surface",
                    .seen = fmt::format("there is no model \"{}\"", model),
                    .limit = "one of " + names_of(surface_models()),
                    .where = InputLocation{.file = {}, .field = "model"}});
  }
  const Result<std::vector<double>> values = ordered(row->spec, parameters);
  if (!values) return failure(values.error());
  return row->make(*values);
}

}  // namespace gonio::reflectance
