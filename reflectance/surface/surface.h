#pragma once

#include <array>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/units.h"
#include "reflectance/batch/direction_block.h"
#include "reflectance/direction/direction.h"
#include "reflectance/integral/integral.h"
#include "reflectance/sampling/direction_sample.h"

namespace gonio::reflectance {

/// A parameter's name and value; the unit is in the name ("wind_m_per_s") or there is none.
struct NamedNumber {
  std::string name;
  double value = 0.0;
  friend bool operator==(const NamedNumber&, const NamedNumber&) = default;
};
using Parameters = std::vector<NamedNumber>;

/// Where a BRDF is hard to integrate. It chooses the quadrature and changes no value.
enum class Feature : std::uint8_t {
  Smooth,   ///< nothing but the horizon
  HotSpot,  ///< a kink at retro-reflection
  Lobe,     ///< a peak about the mirror direction, narrower than a radian
};

/// f_r of one incidence for each lane of a block.
using BrdfBlock = std::array<Brdf, DirectionBlock::kSize>;

/// What a surface's fast evaluation promises: |eval_fast - eval| <= relative_error eval + absolute_error for every pair
/// of directions. Without a kernel the model's own `eval` is called, and both are 0.
struct FastPath {
  bool has_kernel = false;
  double relative_error = 0.0;
  Brdf absolute_error{};
  friend bool operator==(const FastPath&, const FastPath&) = default;
};

/// What every surface can do: one BRDF, split in a smooth part that `eval` gives and a mirror part that it never
/// contains.
///   eval(i, r)       the smooth part of f_r, finite for every pair of directions, horizon included; the same bits for
///                    (i, r) and (r, i) when the surface is reciprocal (Mobley 2005 eq 4)
///   model()          the name that `make_surface` knows it by
///   parameters()     in the order of `make_surface`'s table
///   is_isotropic()   whether only the size of phi_r - phi_i counts: neither a turn nor a mirror image changes it
/// and where it applies
///   rho_dh(i)        the smooth part's directional-hemispherical reflectance, where it has a closed form
///   rho_dh(i, relative_tolerance)
///                    the same by a quadrature of the model's own, where it knows better than any general one
///   specular(i)      the share of the light from i that leaves in mirrored(i) exactly, a delta in the BRDF (eq 9)
///   albedo()         the Bond albedo, mirror part included, where it has a closed form
///   sample(i, draw)  a direction drawn by an inverse in closed form
///   feature()        else Smooth
///   eval_fast(i, r, f), fast_path()
///                    f[k] for each lane of a DirectionBlock by vector code (batch/), and how far it may be from
///                    `eval`; the bits of a lane depend on nothing but i and that lane
/// All are pure: threads any.
template <class M>
concept SurfaceModel = std::copyable<M> && requires(const M m, const Direction& d) {
  { m.eval(d, d) } -> std::same_as<Brdf>;
  { m.model() } -> std::convertible_to<std::string_view>;
  { m.parameters() } -> std::same_as<Parameters>;
  { m.is_isotropic() } -> std::same_as<bool>;
};

struct SurfaceTerm;

/// Any surface, held by value: a scene, a test, a fit need not know which. Copies share the immutable model, so copying
/// is cheap. Threads: any.
class Surface {
 public:
  template <class M>
  requires(!std::same_as<M, Surface> && SurfaceModel<M>) Surface(M model)
      : model_(std::make_shared<const Holder<M>>(std::move(model))) {}  // NOLINT: a model is a surface

  /// The smooth part of the BRDF; a mirror part is told by `specular` alone.
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const { return model_->eval(i, r); }
  [[nodiscard]] Brdf eval(const Geometry& g) const { return eval(incident_direction(g), reflected_direction(g)); }
  /// One incidence, many views: out[k] = eval(i, r[k]), the same bits. The spans have the same length (asserted).
  void eval(const Direction& i, std::span<const Direction> r, std::span<Brdf> out) const { model_->eval(i, r, out); }

  /// As above by vector code where the model has a kernel: within fast_path() of eval(i, r[k]), the same bits however a
  /// batch is split and whichever vector unit the processor has.
  void eval_fast(const Direction& i, std::span<const Direction> r, std::span<Brdf> out) const;
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f) const { model_->eval_fast(i, r, f); }
  [[nodiscard]] FastPath fast_path() const { return model_->fast_path(); }

  /// Directional-hemispherical reflectance of the smooth part, where a formula gives it.
  [[nodiscard]] std::optional<double> closed_rho_dh(const Direction& i) const { return model_->closed_rho_dh(i); }
  /// The same by the model's own quadrature, where it has one.
  [[nodiscard]] std::optional<Integral> own_rho_dh(const Direction& i, double relative_tolerance) const {
    return model_->own_rho_dh(i, relative_tolerance);
  }
  /// The share of the light from i that leaves exactly in the direction mirrored(i); 0 without a mirror part.
  [[nodiscard]] double specular(const Direction& i) const { return model_->specular(i); }

  /// The Bond albedo, mirror part included, where a formula gives it.
  [[nodiscard]] std::optional<double> closed_albedo() const { return model_->closed_albedo(); }
  /// A direction drawn in proportion to f mu_r, where an inverse in closed form gives it.
  [[nodiscard]] std::optional<DirectionSample> closed_sample(const Direction& i, UnitPoint draw) const {
    return model_->closed_sample(i, draw);
  }

  [[nodiscard]] std::string_view model() const { return model_->model(); }
  [[nodiscard]] Parameters parameters() const { return model_->parameters(); }
  [[nodiscard]] bool is_isotropic() const { return model_->is_isotropic(); }
  [[nodiscard]] Feature feature() const { return model_->feature(); }
  /// The surfaces that this one is a weighted sum of; empty when it is no sum.
  [[nodiscard]] std::span<const SurfaceTerm> terms() const;

  /// The model itself, or null when this is another one.
  template <SurfaceModel M>
  [[nodiscard]] const M* as() const {
    const auto* holder = dynamic_cast<const Holder<M>*>(model_.get());
    return holder == nullptr ? nullptr : &holder->model_value;
  }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual Brdf eval(const Direction& i, const Direction& r) const = 0;
    virtual void eval(const Direction& i, std::span<const Direction> r, std::span<Brdf> out) const = 0;
    virtual void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f) const = 0;
    virtual FastPath fast_path() const = 0;
    virtual std::optional<double> closed_rho_dh(const Direction& i) const = 0;
    virtual std::optional<Integral> own_rho_dh(const Direction& i, double relative_tolerance) const = 0;
    virtual double specular(const Direction& i) const = 0;
    virtual std::optional<double> closed_albedo() const = 0;
    virtual std::optional<DirectionSample> closed_sample(const Direction& i, UnitPoint draw) const = 0;
    virtual std::string_view model() const = 0;
    virtual Parameters parameters() const = 0;
    virtual bool is_isotropic() const = 0;
    virtual Feature feature() const = 0;
    virtual std::span<const SurfaceTerm> terms() const = 0;
  };

  template <class M>
  struct Holder;

  std::shared_ptr<const Interface> model_;
};

/// A summand of a sum of surfaces: weight x surface.
struct SurfaceTerm {
  Surface surface;
  double weight = 1.0;
};

inline std::span<const SurfaceTerm> Surface::terms() const {
  return model_->terms();
}

/// How `Surface` holds a model: what the model does not offer gets its neutral answer here.
template <class M>
struct Surface::Holder final : Surface::Interface {
  explicit Holder(M model) : model_value(std::move(model)) {}

  Brdf eval(const Direction& i, const Direction& r) const override { return model_value.eval(i, r); }

  void eval(const Direction& i, std::span<const Direction> r, std::span<Brdf> out) const override {
    assert(r.size() == out.size());
    for (std::size_t k = 0; k < r.size(); ++k) out[k] = model_value.eval(i, r[k]);
  }

  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f) const override {
    if constexpr (requires { model_value.eval_fast(i, r, f); })
      model_value.eval_fast(i, r, f);
    else
      for (std::size_t k = 0; k < f.size(); ++k) f[k] = model_value.eval(i, r.at(k));
  }

  FastPath fast_path() const override {
    if constexpr (requires { model_value.fast_path(); })
      return model_value.fast_path();
    else
      return {};
  }

  std::optional<double> closed_rho_dh(const Direction& i) const override {
    if constexpr (requires { model_value.rho_dh(i); })
      return model_value.rho_dh(i);
    else
      return std::nullopt;
  }

  std::optional<Integral> own_rho_dh(const Direction& i, double relative_tolerance) const override {
    if constexpr (requires { model_value.rho_dh(i, relative_tolerance); })
      return model_value.rho_dh(i, relative_tolerance);
    else
      return std::nullopt;
  }

  double specular(const Direction& i) const override {
    if constexpr (requires { model_value.specular(i); })
      return model_value.specular(i);
    else
      return 0.0;
  }

  std::optional<double> closed_albedo() const override {
    if constexpr (requires { model_value.albedo(); })
      return model_value.albedo();
    else
      return std::nullopt;
  }

  std::optional<DirectionSample> closed_sample(const Direction& i, UnitPoint draw) const override {
    if constexpr (requires { model_value.sample(i, draw); })
      return model_value.sample(i, draw);
    else
      return std::nullopt;
  }

  std::string_view model() const override { return model_value.model(); }
  Parameters parameters() const override { return model_value.parameters(); }
  bool is_isotropic() const override { return model_value.is_isotropic(); }

  Feature feature() const override {
    if constexpr (requires { model_value.feature(); })
      return model_value.feature();
    else
      return Feature::Smooth;
  }

  std::span<const SurfaceTerm> terms() const override {
    if constexpr (requires { model_value.terms(); })
      return model_value.terms();
    else
      return {};
  }

  M model_value;
};

}  // namespace gonio::reflectance
