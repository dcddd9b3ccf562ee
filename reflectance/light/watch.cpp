#include "reflectance/light/watch.h"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "reflectance/integral/hemisphere_integral.h"
#include "reflectance/light/brightness.h"

namespace gonio::reflectance {
namespace {

std::string text_of(const Direction& d) {
  return fmt::format("theta {:.9g} deg, phi {:.9g} deg", in_degrees(d.theta()), in_degrees(d.phi()));
}

struct Watched {
  Surface surface;
  Watch* watch;

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(watch->brdf(surface, i, r));
  }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f) const {
    surface.eval_fast(i, r, f);
    for (std::size_t k = 0; k < f.size(); ++k) {
      if (is_brightness(f[k].si())) continue;
      f[k] = per_steradian(watch->noted_brdf(f[k], surface, i, r.at(k)));
    }
  }
  [[nodiscard]] FastPath fast_path() const { return surface.fast_path(); }
  // A quadrature of the model's own does not pass by here: some views stand for its nodes.
  [[nodiscard]] std::optional<Integral> rho_dh(const Direction& i, double relative_tolerance) const {
    const std::optional<Integral> own = surface.own_rho_dh(i, relative_tolerance);
    if (own) {
      for (const HemisphereNode& node : gauss_rings(8, 16, RingSpacing::Mu)) {
        static_cast<void>(watch->brdf(surface, i, node.direction));
      }
    }
    return own;
  }
  [[nodiscard]] double specular(const Direction& i) const { return surface.specular(i); }
  [[nodiscard]] std::string_view model() const { return surface.model(); }
  [[nodiscard]] Parameters parameters() const { return surface.parameters(); }
  [[nodiscard]] bool is_isotropic() const { return surface.is_isotropic(); }
  [[nodiscard]] Feature feature() const { return surface.feature(); }
};

}  // namespace

double Watch::radiance(const Sky& sky, const Direction& i) {
  ++radiances_;
  return noted(sky.radiance(i), i);
}

std::optional<double> Watch::ring_mean(const Sky& sky, const Direction& i) {
  const std::optional<double> mean = sky.ring_mean(i);
  if (!mean) return std::nullopt;
  ++radiances_;
  return noted(*mean, i);
}

double Watch::noted(double value, const Direction& i) {
  if (is_brightness(value)) return value;
  if (!error_) {
    error_ = Error{.code = ErrorCode::InvalidInput,
                   .tried = "integrate over the incident light",
                   .seen = fmt::format("radiance {} from {}", value, text_of(i)),
                   .limit = "finite, at least 0",
                   .where = InputLocation{.file = {}, .field = "radiance"}};
  }
  return 0.0;
}

double Watch::brdf(const Surface& surface, const Direction& i, const Direction& r) {
  return noted_brdf(surface.eval(i, r), surface, i, r);
}

double Watch::noted_brdf(Brdf f, const Surface& surface, const Direction& i, const Direction& r) {
  const double value = in_per_steradian(f);
  if (value >= 0.0 && std::isfinite(value)) return value;
  if (std::isfinite(value)) {
    has_seen_negative_brdf_ = true;
    return value;
  }
  if (!error_) {
    error_ = Error{.code = ErrorCode::InvalidInput,
                   .tried = "integrate over the incident light",
                   .seen = fmt::format("BRDF {} of {} from {} to {}", value, surface.model(), text_of(i), text_of(r)),
                   .limit = "finite",
                   .where = InputLocation{.file = {}, .field = "brdf"}};
  }
  return 0.0;
}

Surface watched(const Surface& surface, Watch& watch) {
  if (surface.closed_rho_dh(Direction())) return surface;
  return Watched{.surface = surface, .watch = &watch};
}

}  // namespace gonio::reflectance
