#include "reflectance/check/symmetry_groups.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "reflectance/convention/axis_angles.h"
#include "reflectance/direction/direction_pair.h"

namespace gonio::reflectance {

using namespace gonio::literals;

namespace {

constexpr Angle kNever = radians(std::numeric_limits<double>::infinity());

DirectionPair image(Symmetry symmetry, const DirectionPair& p) {
  if (symmetry == Symmetry::Reciprocity) return {.i = p.r, .r = p.i};
  return {.i = p.i, .r = Direction::from_angles(p.r.theta(), p.i.phi() - azimuth_difference(p.i, p.r))};
}

Angle exact_distance(const DirectionPair& a, const DirectionPair& b) {
  return std::max(phase_angle(a.i, b.i), phase_angle(a.r, b.r));
}

// With i of both turned to phi = 0, or mirrored there.
Angle turned_distance(const DirectionPair& a, const DirectionPair& b, Angle tolerance, bool mirrors) {
  const auto size = [](Angle x) { return x < 0.0_deg ? -x : x; };
  const Angle theta_i = size(a.i.theta() - b.i.theta());
  const Angle theta_r = size(a.r.theta() - b.r.theta());
  if (std::max(theta_i, theta_r) > tolerance) return kNever;
  if (std::max(a.i.theta(), b.i.theta()) <= tolerance) return std::max(theta_i, theta_r);
  const auto turned = [](const DirectionPair& p, double sign) {
    return Direction::from_angles(p.r.theta(), sign * azimuth_difference(p.i, p.r));
  };
  Angle arc = phase_angle(turned(a, 1.0), turned(b, 1.0));
  if (mirrors) arc = std::min(arc, phase_angle(turned(a, 1.0), turned(b, -1.0)));
  return std::max(theta_i, arc);
}

Angle distance(const DirectionPair& a, const DirectionPair& b, const SymmetryOptions& options) {
  if (options.sameness == Sameness::Exact) return exact_distance(a, b);
  return turned_distance(a, b, options.tolerance, options.sameness == Sameness::TurnedOrMirrored);
}

// The points in order of theta_i: what may be the same as a geometry lies in a narrow band of it.
class Band {
 public:
  explicit Band(const std::vector<DirectionPair>& pairs) : pairs_(pairs), order_(pairs.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return pairs[a].i.theta() < pairs[b].i.theta(); });
  }

  template <class Visit>
  void around(Angle theta_i, Angle tolerance, Visit visit) const {
    auto at = std::lower_bound(order_.begin(), order_.end(), theta_i - tolerance,
                               [&](std::size_t k, Angle t) { return pairs_[k].i.theta() < t; });
    for (; at != order_.end() && pairs_[*at].i.theta() <= theta_i + tolerance; ++at) visit(*at);
  }

 private:
  const std::vector<DirectionPair>& pairs_;
  std::vector<std::size_t> order_;
};

Error bad_point(std::size_t k, const char* name, Angle angle, const char* limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("check the symmetry of point {}", k),
          .seen = fmt::format("{} {} deg", name, in_degrees(angle)),
          .limit = limit};
}

Result<DirectionPair> directions_of(std::size_t k, const Geometry& g) {
  const auto is_arm = [](Angle theta) { return theta >= -90.0_deg && theta <= 90.0_deg; };
  constexpr const char* kArm = "-90 to 90 deg";
  constexpr const char* kFinite = "a finite angle";
  if (!is_arm(g.theta_i)) return failure(bad_point(k, "theta_i", g.theta_i, kArm));
  if (!is_arm(g.theta_r)) return failure(bad_point(k, "theta_r", g.theta_r, kArm));
  if (!std::isfinite(g.phi_i.si())) return failure(bad_point(k, "phi_i", g.phi_i, kFinite));
  if (!std::isfinite(g.phi_r.si())) return failure(bad_point(k, "phi_r", g.phi_r, kFinite));
  return DirectionPair{.i = incident_direction(g), .r = reflected_direction(g)};
}

SymmetryGroups find_pairs(Symmetry symmetry, const std::vector<DirectionPair>& pairs, const SymmetryOptions& options) {
  SymmetryGroups found;
  const Band band(pairs);
  std::vector<bool> is_taken(pairs.size(), false);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (distance(image(symmetry, pairs[k]), pairs[k], options) > options.tolerance) continue;
    is_taken[k] = true;
    ++found.trivial;
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (is_taken[k]) continue;
    is_taken[k] = true;
    const DirectionPair wanted = image(symmetry, pairs[k]);
    std::optional<std::size_t> nearest;
    Angle least = options.tolerance;
    band.around(wanted.i.theta(), options.tolerance, [&](std::size_t other) {
      if (is_taken[other]) return;
      const Angle d = distance(wanted, pairs[other], options);
      if (d > least || (nearest && d == least)) return;
      nearest = other;
      least = d;
    });
    if (!nearest) {
      ++found.unpaired;
      continue;
    }
    is_taken[*nearest] = true;
    found.groups.push_back({k, *nearest});
  }
  return found;
}

SymmetryGroups find_turns(const std::vector<DirectionPair>& pairs, Angle tolerance) {
  SymmetryGroups found;
  const Band band(pairs);
  std::vector<bool> is_taken(pairs.size(), false);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (is_taken[k]) continue;
    is_taken[k] = true;
    if (std::max(pairs[k].i.theta(), pairs[k].r.theta()) <= tolerance) {
      ++found.trivial;
      continue;
    }
    std::vector<std::size_t> group{k};
    std::size_t repeated = 0;
    band.around(pairs[k].i.theta(), tolerance, [&](std::size_t other) {
      if (is_taken[other] || turned_distance(pairs[k], pairs[other], tolerance, false) > tolerance) return;
      is_taken[other] = true;
      const bool is_repeat = std::any_of(group.begin(), group.end(), [&](std::size_t member) {
        return exact_distance(pairs[member], pairs[other]) <= tolerance;
      });
      if (is_repeat) {
        ++repeated;
      } else {
        group.push_back(other);
      }
    });
    found.repeated += repeated;
    if (group.size() == 1) {
      ++found.unpaired;
    } else {
      found.groups.push_back(std::move(group));
    }
  }
  return found;
}

}  // namespace

Result<SymmetryGroups> find_symmetry_groups(Symmetry symmetry, std::span<const SymmetryPoint> points,
                                            const SymmetryOptions& options) {
  GONIO_TRY(check_angle("the options of a symmetry check", "tolerance", options.tolerance, 0.0_deg, 5.0_deg));
  std::vector<DirectionPair> pairs;
  pairs.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Result<DirectionPair> pair = directions_of(k, points[k].geometry);
    if (!pair) return failure(pair.error());
    pairs.push_back(*pair);
  }
  return symmetry == Symmetry::Turn ? find_turns(pairs, options.tolerance) : find_pairs(symmetry, pairs, options);
}

}  // namespace gonio::reflectance
