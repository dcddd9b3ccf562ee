#include "sim/optics/polarised_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflectance/surface/glint.h"

namespace gonio::sim {
namespace {

using reflectance::Direction;

Vector preferred(Angle theta, Angle phi, Angle plane) {
  const Vector across = horizontal(phi);
  const Vector towards_normal = cross(unit_vector(theta, phi), across);
  return std::cos(plane.si()) * across + std::sin(plane.si()) * towards_normal;
}

// An axis carried to a direction nearby.
Vector carried(const Vector& axis, const Vector& direction) {
  return normalised(axis - dot(axis, direction) * direction);
}

// 0: not made of facets.
double index_of_facets(const reflectance::Surface& surface) {
  if (surface.as<reflectance::Glint>() == nullptr) return 0.0;
  const auto parameters = surface.parameters();
  return std::ranges::find(parameters, "refractive_index", &reflectance::NamedNumber::name)->value;
}

// Amplitudes of reflection at a clear interface, s and p, with p counted positive along s x (direction of travel).
struct Amplitudes {
  double s = 0.0;
  double p = 0.0;
};

Amplitudes fresnel_amplitudes(double cos_theta, double n) {
  const double t = std::sqrt(1.0 - (1.0 - cos_theta * cos_theta) / (n * n));
  return {.s = (cos_theta - n * t) / (cos_theta + n * t), .p = (n * cos_theta - t) / (n * cos_theta + t)};
}

}  // namespace

PolarisationAxes polarisation_axes(const PolarisationSpec& spec, const Geometry& g) {
  return {.source = preferred(g.theta_i, g.phi_i, spec.source_plane),
          .detector = preferred(g.theta_r, g.phi_r, spec.detector_plane)};
}

PolarisedSample::PolarisedSample(const PolarisationSpec& spec, std::span<const reflectance::SurfaceTerm> terms)
    : spec_(spec) {
  for (const auto& term : terms) terms_.push_back({.term = term, .refractive_index = index_of_facets(term.surface)});
}

double PolarisedSample::facet_factor(double n, const Vector& i, const Vector& r, const PolarisationAxes& axes) const {
  const Vector facet = normalised(i + r);
  const Vector normal_to_plane = cross(i, r);
  // Light straight back: any plane does, for s and p are the same but for the sign that the mirror gives.
  const Vector s =
      dot(normal_to_plane, normal_to_plane) > 1e-24 ? normalised(normal_to_plane) : carried(axes.source, i);
  const Vector p_in = cross(s, -1.0 * i);
  const Vector p_out = cross(s, r);
  const Amplitudes a = fresnel_amplitudes(dot(facet, i), n);
  const Vector lamp = carried(axes.source, i);
  const Vector eye = carried(axes.detector, r);
  const auto passed = [&](const Vector& in, const Vector& out) {
    const double amplitude = a.s * dot(in, s) * dot(out, s) + a.p * dot(in, p_in) * dot(out, p_out);
    return amplitude * amplitude;
  };
  const std::array<Vector, 2> ins{lamp, cross(i, lamp)};
  const std::array<Vector, 2> outs{eye, cross(r, eye)};
  double sum = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t m = 0; m < 2; ++m) {
      const double lit = 1.0 + (k == 0 ? 1.0 : -1.0) * spec_.source_degree;
      const double seen = 1.0 + (m == 0 ? 1.0 : -1.0) * spec_.detector_diattenuation;
      sum += lit * seen * passed(ins[k], outs[m]);
    }
  }
  return sum / (a.s * a.s + a.p * a.p);
}

Brdf PolarisedSample::seen(const Direction& i, const Direction& r, const PolarisationAxes& axes) const {
  Brdf sum;
  for (const Term& t : terms_) {
    const Brdf plain = t.term.weight * t.term.surface.eval(i, r);
    const bool polarises = t.refractive_index != 0.0 && plain.si() != 0.0;
    sum += polarises ? plain * facet_factor(t.refractive_index, i.vector(), r.vector(), axes) : plain;
  }
  return sum;
}

}  // namespace gonio::sim
