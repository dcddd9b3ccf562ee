#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/units.h"
#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// What every sky can do: light spread over the hemisphere, without deltas and without edges.
///   radiance(i)      L_i from direction i, finite and at least 0, horizon included
/// and, where it applies, what tells the quadrature where the sky is hard; none of it changes a value:
///   is_zonal()       whether the radiance depends on theta alone
///   ring_mean(i)     the mean radiance over the azimuths at the theta of i, where it has a closed form
///   theta_breaks()   thetas, ascending, between 0 and 90 deg, where the radiance has a kink all around
///   phi_breaks()     azimuths, ascending, where it has one all the way up
///   peak()           a direction about which it rises to a point: the aureole of a sun
template <class M>
concept SkyModel = std::copyable<M> && requires(const M m, const Direction& i) {
  { m.radiance(i) } -> std::same_as<double>;
};

/// Any sky, held by value; copies share the immutable model. Threads: any, as far as the model's own radiance is.
class Sky {
 public:
  template <class M>
  requires(!std::same_as<M, Sky> && SkyModel<M>) Sky(M model)
      : model_(std::make_shared<const Holder<M>>(std::move(model))) {}  // NOLINT: a model is a sky

  [[nodiscard]] double radiance(const Direction& i) const { return model_->radiance(i); }
  [[nodiscard]] bool is_zonal() const { return model_->is_zonal(); }
  [[nodiscard]] std::optional<double> ring_mean(const Direction& i) const { return model_->ring_mean(i); }
  [[nodiscard]] std::vector<Angle> theta_breaks() const { return model_->theta_breaks(); }
  [[nodiscard]] std::vector<Angle> phi_breaks() const { return model_->phi_breaks(); }
  [[nodiscard]] std::optional<Direction> peak() const { return model_->peak(); }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual double radiance(const Direction& i) const = 0;
    virtual bool is_zonal() const = 0;
    virtual std::optional<double> ring_mean(const Direction& i) const = 0;
    virtual std::vector<Angle> theta_breaks() const = 0;
    virtual std::vector<Angle> phi_breaks() const = 0;
    virtual std::optional<Direction> peak() const = 0;
  };

  template <class M>
  struct Holder;

  std::shared_ptr<const Interface> model_;
};

/// How `Sky` holds a model: what the model does not offer gets its neutral answer here.
template <class M>
struct Sky::Holder final : Sky::Interface {
  explicit Holder(M m) : model(std::move(m)) {}

  double radiance(const Direction& i) const override { return model.radiance(i); }

  bool is_zonal() const override {
    if constexpr (requires { model.is_zonal(); })
      return model.is_zonal();
    else
      return false;
  }

  std::optional<double> ring_mean(const Direction& i) const override {
    if constexpr (requires { model.ring_mean(i); })
      return model.ring_mean(i);
    else
      return is_zonal() ? std::optional(radiance(i)) : std::nullopt;
  }

  std::vector<Angle> theta_breaks() const override {
    if constexpr (requires { model.theta_breaks(); })
      return model.theta_breaks();
    else
      return {};
  }

  std::vector<Angle> phi_breaks() const override {
    if constexpr (requires { model.phi_breaks(); })
      return model.phi_breaks();
    else
      return {};
  }

  std::optional<Direction> peak() const override {
    if constexpr (requires { model.peak(); })
      return model.peak();
    else
      return std::nullopt;
  }

  M model;
};

}  // namespace gonio::reflectance
