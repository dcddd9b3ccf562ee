#include "reflectance/integral/polar_integral.h"

#include <cmath>
#include <numbers>

#include "reflectance/integral/refinement.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

constexpr int kFirstLevel = 2;
constexpr int kLastLevel = 6;

// One meridian: r at the arc xi from the axis in the azimuth psi about it, psi = 0 towards the normal; up to the
// horizon.
class Meridian {
 public:
  Meridian(const Direction& axis, double cos_psi, double sin_psi)
      : axis_(axis),
        cos_psi_(cos_psi),
        sin_psi_(sin_psi),
        rise_(std::hypot(axis.mu(), axis.sin_theta() * cos_psi)),
        length_(std::atan2(axis.mu(), -axis.sin_theta() * cos_psi)) {}

  [[nodiscard]] double length() const { return length_; }

  // `left` = length - xi, given apart: mu = rise sin(left) keeps its digits at the horizon.
  [[nodiscard]] Direction at(double xi, double left) const {
    const double sin_xi = std::sin(xi);
    const double mu = rise_ * std::sin(left);
    const double forward = std::cos(xi) * axis_.sin_theta() - sin_xi * cos_psi_ * axis_.mu();
    const double aside = sin_xi * sin_psi_;
    const Angle turn = radians(std::atan2(aside, forward));
    return Direction::from_cosine(mu, std::hypot(forward, aside), axis_.phi() + turn);
  }

 private:
  Direction axis_;
  double cos_psi_;
  double sin_psi_;
  double rise_;
  double length_;
};

// f mu sin(xi) dxi along one meridian.
void add_meridian(const Surface& surface, const Direction& i, const Meridian& meridian, double weight,
                  const std::vector<EndNode>& rule, RuleSum& sum) {
  for (const EndNode& node : rule) {
    const double xi = meridian.length() * node.x;
    const Direction r = meridian.at(xi, meridian.length() * node.rest);
    const double f = in_per_steradian(surface.eval(i, r));
    sum.add(weight * node.weight * meridian.length() * f * r.mu() * std::sin(xi));
  }
}

// psi in quarters: at grazing axes the horizon bends sharply at psi = +-90 deg, where quarters meet.
RuleSum at_level(const Surface& surface, const Direction& i, const Direction& axis, int level) {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  const std::vector<EndNode> rule = tanh_sinh(level);
  const double sides = surface.is_isotropic() ? 2.0 : 1.0;  // psi and -psi see the same
  RuleSum sum;
  for (const EndNode& node : rule) {
    const double weight = sides * node.weight * kQuarter;
    const double c = std::sin(kQuarter * node.rest);
    const double s = std::sin(kQuarter * node.x);
    add_meridian(surface, i, Meridian(axis, c, s), weight, rule, sum);
    add_meridian(surface, i, Meridian(axis, -c, s), weight, rule, sum);
    if (surface.is_isotropic()) continue;
    add_meridian(surface, i, Meridian(axis, c, -s), weight, rule, sum);
    add_meridian(surface, i, Meridian(axis, -c, -s), weight, rule, sum);
  }
  return sum;
}

}  // namespace

Integral polar_integral(const Surface& surface, const Direction& i, const Direction& axis, double relative_tolerance) {
  return refined(kFirstLevel, kLastLevel, relative_tolerance,
                 [&](int level) { return at_level(surface, i, axis, level); });
}

}  // namespace gonio::reflectance
