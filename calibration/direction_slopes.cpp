#include "calibration/direction_slopes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

namespace gonio::calibration {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kFarthest = 0.25 * kHalfTurn;  // a polynomial over more than 45 deg says nothing of a slope
constexpr double kSamePlace = 2e-4;             // 0.01 deg: closer neighbours give noise over nothing
constexpr std::size_t kNeighboursAtMost = 4;

std::size_t index_of(DirectionAxis axis) {
  return static_cast<std::size_t>(axis);
}

std::int64_t key_of(Angle a) {
  return std::llround(in_degrees(a) * 1e3);
}
std::int64_t key_of(Wavelength l) {
  return std::llround(in_nanometres(l) * 1e3);
}

/// One point as it stands on a line: `sign` says whether its own angle grows along the line or against it.
struct Stop {
  double coordinate = 0.0;
  std::size_t point = 0;
  double sign = 1.0;
  bool is_image = false;  ///< of a point that stands elsewhere on the same line itself
};
using Line = std::vector<Stop>;
/// wavelength, the two fixed angles, phi_i where it counts.
using LineKey = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

Angle dphi_of(const Geometry& g, bool isotropic) {
  const Angle d = wrapped(g.phi_r - g.phi_i);
  return isotropic && d < Angle{} ? -d : d;
}

/// Sorts points into lines along one of the thetas.
class ThetaLines {
 public:
  ThetaLines(std::span<const SlopePoint> points, bool isotropic, DirectionAxis axis)
      : points_(points), isotropic_(isotropic), moves_i_(axis == DirectionAxis::ThetaI) {
    for (std::size_t n = 0; n < points.size(); ++n) add(n);
    add_poles();
  }
  [[nodiscard]] std::map<LineKey, Line>& lines() { return lines_; }

 private:
  [[nodiscard]] Angle moving(const Geometry& g) const { return moves_i_ ? g.theta_i : g.theta_r; }
  [[nodiscard]] Angle fixed(const Geometry& g) const { return moves_i_ ? g.theta_r : g.theta_i; }

  void add(std::size_t n) {
    const SlopePoint& p = points_[n];
    const std::int64_t d = key_of(dphi_of(p.planned, isotropic_));
    const std::int64_t quarter = 90000;
    const double theta = moving(p.reported).si();
    const bool other_at_pole = key_of(fixed(p.planned)) == 0;
    // The opposite half plane: dphi + 180 deg; mirrored, 180 deg - dphi.
    const bool against = isotropic_ ? d > quarter : d > quarter || d <= -quarter;
    std::int64_t plane = against ? (d > 0 ? d - 2 * quarter : d + 2 * quarter) : d;
    if (isotropic_) plane = against ? 2 * quarter - d : d;
    if (isotropic_ && other_at_pole) plane = 0;
    const double sign = against && !(isotropic_ && other_at_pole) ? -1.0 : 1.0;
    const LineKey key{key_of(p.wavelength), key_of(fixed(p.planned)), plane, isotropic_ ? 0 : key_of(p.planned.phi_i)};
    Line& line = lines_[key];
    line.push_back({sign * theta, n, sign, false});
    const bool is_pole = key_of(moving(p.planned)) == 0;
    if (is_pole) poles_.emplace_back(key, n);
    // A plane that is its own mirror image continues beyond the normal as it came.
    const bool is_even = isotropic_ && (other_at_pole || plane == quarter);
    if (is_even && !is_pole) line.push_back({-sign * theta, n, -sign, true});
  }

  // A point at the normal lies on every line through it.
  void add_poles() {
    for (const auto& [own, n] : poles_) {
      const auto [wavelength, fixed_angle, plane, phi_i] = own;
      const auto from = lines_.lower_bound({wavelength, fixed_angle, INT64_MIN, INT64_MIN});
      for (auto line = from; line != lines_.end(); ++line) {
        const auto [w, a, other_plane, other_phi_i] = line->first;
        if (w != wavelength || a != fixed_angle) break;
        if (other_plane == plane || other_phi_i != phi_i) continue;
        line->second.push_back({moving(points_[n].reported).si(), n, 1.0, true});
      }
    }
  }

  std::span<const SlopePoint> points_;
  bool isotropic_;
  bool moves_i_;
  std::map<LineKey, Line> lines_;
  std::vector<std::pair<LineKey, std::size_t>> poles_;
};

std::map<LineKey, Line> phi_lines(std::span<const SlopePoint> points, bool isotropic) {
  std::map<LineKey, Line> lines;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Geometry& g = points[n].planned;
    const double d = dphi_of(points[n].reported, isotropic).si();
    Line& line =
        lines[{key_of(points[n].wavelength), key_of(g.theta_i), key_of(g.theta_r), isotropic ? 0 : key_of(g.phi_i)}];
    // An isotropic sample's own angle is |dphi|: where phi_r - phi_i is negative it grows against it.
    const double sign =
        isotropic && wrapped(points[n].reported.phi_r - points[n].reported.phi_i) < Angle{} ? -1.0 : 1.0;
    line.push_back({d, n, sign, false});
    if (isotropic) {
      line.push_back({-d, n, -sign, true});
      line.push_back({2.0 * kHalfTurn - d, n, -sign, true});
    } else {
      line.push_back({d + 2.0 * kHalfTurn, n, sign, true});
      line.push_back({d - 2.0 * kHalfTurn, n, sign, true});
    }
  }
  return lines;
}

// Weights w_j of the derivative at x = 0 of the polynomial through nodes at x_j (Lagrange).
std::vector<double> derivative_weights(const std::vector<double>& x) {
  std::vector<double> weights(x.size(), 0.0);
  for (std::size_t j = 0; j < x.size(); ++j) {
    double sum = 0.0;  // over k of prod_{m != j, k} (0 - x_m) / prod_{m != j} (x_j - x_m)
    double below = 1.0;
    for (std::size_t m = 0; m < x.size(); ++m) {
      if (m != j) below *= x[j] - x[m];
    }
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (k == j) continue;
      double product = 1.0;
      for (std::size_t m = 0; m < x.size(); ++m) {
        if (m != j && m != k) product *= -x[m];
      }
      sum += product;
    }
    weights[j] = sum / below;
  }
  return weights;
}

// The nearest stops of a sorted line, nearest first; of two as near, the one below. A point's own mirror image is left
// out: it says that the line is even, and nothing of its slope.
std::vector<const Stop*> nearest(const Line& line, std::size_t own) {
  std::vector<const Stop*> found;
  std::size_t below = own;
  std::size_t above = own + 1;
  const double x0 = line[own].coordinate;
  double last_below = x0;
  double last_above = x0;
  const auto is_useless = [&](const Stop& stop, double last) {
    return stop.point == line[own].point || std::abs(stop.coordinate - last) < kSamePlace;
  };
  while (found.size() < kNeighboursAtMost) {
    while (below > 0 && is_useless(line[below - 1], last_below)) --below;
    while (above < line.size() && is_useless(line[above], last_above)) ++above;
    const double down = below > 0 ? x0 - line[below - 1].coordinate : INFINITY;
    const double up = above < line.size() ? line[above].coordinate - x0 : INFINITY;
    if (std::min(down, up) > kFarthest) break;
    if (down <= up + kSamePlace) {
      found.push_back(&line[--below]);
      last_below = found.back()->coordinate;
    } else {
      found.push_back(&line[above++]);
      last_above = found.back()->coordinate;
    }
  }
  return found;
}

struct LineSlope {
  double slope = 0.0;
  double unresolved = 0.0;
  bool has_neighbours = false;
};

/// The values along a line as they are to be differentiated: ln f where all of them stand clear of zero, else f itself.
struct Differentiable {
  std::vector<double> value;
  std::vector<double> u;
  double per_unit = 1.0;  ///< df for a change of 1
};

Differentiable differentiable(std::span<const SlopePoint> points, const std::vector<const Stop*>& nodes) {
  constexpr double kClearOfZero = 5.0;  // standard uncertainties: then ln f is normal too
  const bool has_logarithm = std::ranges::all_of(nodes, [&](const Stop* node) {
    const SlopePoint& p = points[node->point];
    return p.value > kClearOfZero * p.u_random && p.value > Brdf{};
  });
  Differentiable d;
  for (const Stop* node : nodes) {
    const double f = points[node->point].value.si();
    const double u = points[node->point].u_random.si();
    d.value.push_back(has_logarithm ? std::log(f) : f);
    d.u.push_back(has_logarithm ? u / f : u);
  }
  if (has_logarithm) d.per_unit = points[nodes.front()->point].value.si();
  return d;
}

struct Estimate {
  double slope = 0.0;
  double noise = 0.0;
};

// Element p is that of the polynomial through the point and its p nearest neighbours; element 0 is a slope of 0.
std::vector<Estimate> estimates(const std::vector<const Stop*>& nodes, const Differentiable& d) {
  std::vector<Estimate> found = {{}};
  std::vector<double> x = {0.0};
  for (std::size_t order = 1; order < nodes.size(); ++order) {
    x.push_back(nodes[order]->coordinate - nodes.front()->coordinate);
    const std::vector<double> weights = derivative_weights(x);
    Estimate e;
    for (std::size_t j = 0; j <= order; ++j) {
      e.slope += weights[j] * d.value[j];
      e.noise = std::hypot(e.noise, weights[j] * d.u[j]);
    }
    found.push_back(e);
  }
  return found;
}

LineSlope slope_on_line(std::span<const SlopePoint> points, const Line& line, std::size_t own) {
  std::vector<const Stop*> nodes = {&line[own]};
  std::ranges::copy(nearest(line, own), std::back_inserter(nodes));
  const Differentiable d = differentiable(points, nodes);
  const std::vector<Estimate> found = estimates(nodes, d);
  LineSlope best;
  double least = INFINITY;
  for (std::size_t p = 1; p < found.size(); ++p) {
    double missed = std::abs(found[p].slope - found[p - 1].slope);
    // Two orders may agree by accident, three hardly.
    if (p + 1 < found.size()) missed = std::max(missed, std::abs(found[p + 1].slope - found[p].slope));
    const double all = std::hypot(found[p].noise, missed);
    if (all >= least) continue;
    least = all;
    best = {.slope = line[own].sign * d.per_unit * found[p].slope,
            .unresolved = d.per_unit * missed,
            .has_neighbours = true};
  }
  return best;
}

void read_slopes(std::span<const SlopePoint> points, std::map<LineKey, Line>& lines, DirectionAxis axis,
                 std::vector<DirectionSlopes>& out) {
  const std::size_t a = index_of(axis);
  for (auto& [key, line] : lines) {
    std::ranges::stable_sort(line, {}, &Stop::coordinate);
    for (std::size_t s = 0; s < line.size(); ++s) {
      if (line[s].is_image) continue;
      const LineSlope found = slope_on_line(points, line, s);
      DirectionSlopes& slopes = out[line[s].point];
      slopes.slope[a] = found.slope;
      slopes.unresolved[a] = found.unresolved;
      slopes.has_neighbours[a] = found.has_neighbours;
    }
  }
}

// Where phi means nothing, or where the mirror plane makes the function even, its slope is 0 without any neighbour.
bool has_no_phi_slope(const Geometry& g, bool isotropic) {
  if (key_of(g.theta_r) == 0) return true;
  if (!isotropic) return false;
  const std::int64_t d = key_of(dphi_of(g, true));
  return key_of(g.theta_i) == 0 || d == 0 || d == 180000;
}

void guess_the_rest(const SlopePoint& point, bool isotropic, DirectionSlopes& s) {
  const std::size_t i = index_of(DirectionAxis::ThetaI);
  const std::size_t r = index_of(DirectionAxis::ThetaR);
  const std::size_t phi = index_of(DirectionAxis::PhiR);
  const auto size = [&](std::size_t a) { return std::hypot(s.slope[a], s.unresolved[a]); };
  if (!s.has_neighbours[i] && !s.has_neighbours[r]) {
    s.unresolved[i] = s.unresolved[r] = std::abs(point.value.si());
  } else if (!s.has_neighbours[i]) {
    s.unresolved[i] = size(r);
  } else if (!s.has_neighbours[r]) {
    s.unresolved[r] = size(i);
  }
  if (has_no_phi_slope(point.planned, isotropic)) {
    s.slope[phi] = s.unresolved[phi] = 0.0;
    s.has_neighbours[phi] = true;
  } else if (!s.has_neighbours[phi]) {
    s.unresolved[phi] = std::max(size(i), size(r)) * std::abs(std::sin(point.reported.theta_r.si()));
  }
}

}  // namespace

std::vector<DirectionSlopes> direction_slopes(std::span<const SlopePoint> points, bool isotropic) {
  std::vector<DirectionSlopes> slopes(points.size());
  for (const DirectionAxis axis : {DirectionAxis::ThetaI, DirectionAxis::ThetaR}) {
    read_slopes(points, ThetaLines(points, isotropic, axis).lines(), axis, slopes);
  }
  auto lines = phi_lines(points, isotropic);
  read_slopes(points, lines, DirectionAxis::PhiR, slopes);
  for (std::size_t n = 0; n < points.size(); ++n) guess_the_rest(points[n], isotropic, slopes[n]);
  return slopes;
}

}  // namespace gonio::calibration
