#pragma once

#include <cassert>
#include <optional>
#include <span>
#include <string_view>

#include "reflectance/surface.h"

namespace gonio::reflectance {

/// How `Surface` holds a model: what the model does not offer gets its neutral answer here.
template <class M>
struct Surface::Holder final : Surface::Interface {
  explicit Holder(M model) : model_value(std::move(model)) {}

  Brdf eval(const Direction& i, const Direction& r) const override { return model_value.eval(i, r); }

  void eval(const Direction& i, std::span<const Direction> r, std::span<Brdf> out) const override {
    assert(r.size() == out.size());
    for (std::size_t k = 0; k < r.size(); ++k) out[k] = model_value.eval(i, r[k]);
  }

  std::optional<double> closed_rho_dh(const Direction& i) const override {
    if constexpr (requires { model_value.rho_dh(i); }) return model_value.rho_dh(i);
    else return std::nullopt;
  }

  double specular(const Direction& i) const override {
    if constexpr (requires { model_value.specular(i); }) return model_value.specular(i);
    else return 0.0;
  }

  std::string_view model() const override { return model_value.model(); }
  Parameters parameters() const override { return model_value.parameters(); }
  bool is_isotropic() const override { return model_value.is_isotropic(); }

  Feature feature() const override {
    if constexpr (requires { model_value.feature(); }) return model_value.feature();
    else return Feature::Smooth;
  }

  std::span<const SurfaceTerm> terms() const override {
    if constexpr (requires { model_value.terms(); }) return model_value.terms();
    else return {};
  }

  M model_value;
};

}  // namespace gonio::reflectance
