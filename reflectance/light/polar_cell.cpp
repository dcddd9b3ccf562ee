#include "reflectance/light/polar_cell.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reflectance/integral/meridian.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

double dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

Vector cross(const Vector& a, const Vector& b) {
  return {.x = a.y * b.z - a.z * b.y, .y = a.z * b.x - a.x * b.z, .z = a.x * b.y - a.y * b.x};
}

Vector scaled(const Vector& a, double k) {
  return {.x = k * a.x, .y = k * a.y, .z = k * a.z};
}

Vector sum(const Vector& a, const Vector& b) {
  return {.x = a.x + b.x, .y = a.y + b.y, .z = a.z + b.z};
}

}  // namespace

PolarCell::PolarCell(const Direction& axis) : axis_(axis) {
  const double c = std::cos(axis.phi().si());
  const double s = std::sin(axis.phi().si());
  up_ = {.x = -axis.mu() * c, .y = -axis.mu() * s, .z = axis.sin_theta()};
  aside_ = {.x = -s, .y = c, .z = 0.0};
  breaks_ = {-kPi, -0.5 * kPi, 0.0, 0.5 * kPi, kPi};  // where the horizon bends sharply for a low axis
}

void PolarCell::keep_nearer_than(const Direction& other) {
  const Vector to_axis = sum(axis_.vector(), scaled(other.vector(), -1.0));
  const double length = std::sqrt(dot(to_axis, to_axis));
  keep(scaled(to_axis, 1.0 / length), 0.5 * length, 0.0);
}

void PolarCell::keep_within(Angle theta, Angle phi, Angle radius) {
  const double s = std::sin(theta.si());
  const Vector centre{.x = s * std::cos(phi.si()), .y = s * std::sin(phi.si()), .z = std::cos(theta.si())};
  const Vector off = sum(axis_.vector(), scaled(centre, -1.0));
  const double edge = std::sin(0.5 * radius.si());
  // cos(arc to the centre) - cos(radius) = 2 (sin^2(radius/2) - sin^2(arc/2)).
  keep(centre, std::max(0.0, 2.0 * edge * edge - 0.5 * dot(off, off)), std::cos(radius.si()));
}

void PolarCell::keep(const Vector& n, double inside, double height) {
  const Edge edge{.n = n,
                  .inside = inside,
                  .height = height,
                  .at_axis = inside + height,
                  .toward = dot(n, up_),
                  .aside = dot(n, aside_)};
  const double nearest = std::atan2(edge.aside, edge.toward);
  for (int quarter = 0; quarter < 4; ++quarter) add_break(nearest + 0.5 * kPi * quarter);
  const Edge horizon{.n = {.x = 0.0, .y = 0.0, .z = 1.0}};
  add_corners(edge, horizon);
  for (const Edge& other : edges_) add_corners(edge, other);
  edges_.push_back(edge);
  std::ranges::sort(breaks_);
}

// Where two edges cross: x = a n_a + b n_b + c (n_a x n_b) with both heights met and length 1.
void PolarCell::add_corners(const Edge& a, const Edge& b) {
  const double cosine = dot(a.n, b.n);
  const double sine2 = 1.0 - cosine * cosine;
  if (sine2 < 1e-24) return;
  const double along_a = (a.height - cosine * b.height) / sine2;
  const double along_b = (b.height - cosine * a.height) / sine2;
  const Vector flat = sum(scaled(a.n, along_a), scaled(b.n, along_b));
  const double left = 1.0 - dot(flat, flat);
  if (left <= 0.0) return;
  const Vector out = scaled(cross(a.n, b.n), std::sqrt(left / sine2));
  for (const double side : {-1.0, 1.0}) {
    const Vector corner = sum(flat, scaled(out, side));
    add_break(std::atan2(dot(corner, aside_), dot(corner, up_)));
  }
}

void PolarCell::add_break(double psi) {
  const double wrapped = std::remainder(psi, 2.0 * kPi);
  const bool is_new = std::ranges::none_of(breaks_, [&](double b) { return std::abs(b - wrapped) < 1e-12; });
  if (is_new) breaks_.push_back(wrapped);
}

// at_axis cos(xi) + tangent sin(xi) = height, solved for tan(xi/2) without cancellation.
double PolarCell::Edge::reach(double cos_psi, double sin_psi) const {
  const double tangent = cos_psi * toward + sin_psi * aside;
  const double root = std::sqrt(tangent * tangent + (at_axis + height) * inside);
  if (tangent < 0.0) return 2.0 * std::atan2(inside, root - tangent);
  return 2.0 * std::atan2(tangent + root, at_axis + height);
}

void PolarCell::add_to(RuleSum& sum, const std::function<double(const Direction&)>& h, int level) const {
  const std::vector<EndNode> rule = tanh_sinh(level);
  for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
    const double piece = breaks_[k + 1] - breaks_[k];
    for (const EndNode& turn : rule) {
      const double psi = breaks_[k] + piece * turn.x;
      const double c = std::cos(psi);
      const double s = std::sin(psi);
      const Meridian meridian(axis_, c, s);
      double reach = meridian.length();
      for (const Edge& edge : edges_) reach = std::min(reach, edge.reach(c, s));
      const double beyond = meridian.length() - reach;
      for (const EndNode& node : rule) {
        const double xi = reach * node.x;
        const Direction i = meridian.at(xi, beyond + reach * node.rest);
        sum.add(piece * turn.weight * node.weight * reach * std::sin(xi) * i.mu() * h(i));
      }
    }
  }
}

}  // namespace gonio::reflectance
