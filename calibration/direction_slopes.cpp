#include "calibration/direction_slopes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/direction_lines.h"
#include "calibration/parallel_blocks.h"
#include "calibration/root_sum.h"

namespace gonio::calibration {
namespace {

constexpr double kSamePlace = 2e-4;  // 0.01 deg: closer neighbours give noise over nothing
constexpr std::size_t kNeighboursAtMost = 4;
constexpr std::size_t kNodesAtMost = kNeighboursAtMost + 1;

SlopeOrdinate ordinate_of(const SlopePoint& p) {
  constexpr double kClearOfZero = 5.0;  // standard uncertainties: then ln f is normal too
  SlopeOrdinate o{.f = p.value.si(), .u = p.u_random.si()};
  o.has_logarithm = o.f > kClearOfZero * o.u && o.f > 0.0;
  if (o.has_logarithm) {
    o.log_f = std::log(o.f);
    o.u_log = o.u / o.f;
  }
  return o;
}

/// A point and its neighbours on a line, nearest first.
struct Nodes {
  std::array<const LineStop*, kNodesAtMost> stop{};
  std::size_t size = 0;
};

// A point's own mirror images: with another neighbour they say how the line bends, for it is even.
void add_own_images(const LineStop& own, Nodes& nodes) {
  if (nodes.size < 2) return;
  const auto add = [&](const LineStop& stop) {
    if (stop.point != own.point || nodes.size == kNodesAtMost) return;
    for (std::size_t n = 0; n < nodes.size; ++n) {
      if (std::abs(stop.coordinate - nodes.stop[n]->coordinate) < kSamePlace) return;
    }
    nodes.stop[nodes.size++] = &stop;
  };
  const double x0 = own.coordinate;
  for (const LineStop* stop = &own - 1; x0 - stop->coordinate < kFarthestStop; --stop) add(*stop);
  for (const LineStop* stop = &own + 1; stop->coordinate - x0 < kFarthestStop; ++stop) add(*stop);
}

// The nearest stops of a sorted line; of two as near, the one below. A point's own mirror image comes last: alone it
// says that the line is even, and nothing of its slope.
Nodes nodes_about(const LineStop& own) {
  Nodes nodes{.stop = {&own}, .size = 1};
  const LineStop* below = &own - 1;
  const LineStop* above = &own + 1;
  const double x0 = own.coordinate;
  double last_below = x0;
  double last_above = x0;
  const auto is_useless = [&](const LineStop& stop, double last) {
    return stop.point == own.point || std::abs(stop.coordinate - last) < kSamePlace;
  };
  while (nodes.size < kNodesAtMost) {
    while (is_useless(*below, last_below)) --below;
    while (is_useless(*above, last_above)) ++above;
    const double down = x0 - below->coordinate;
    const double up = above->coordinate - x0;
    if (std::min(down, up) > kFarthestStop) break;
    const LineStop* next = down <= up + kSamePlace ? below-- : above++;
    (next->coordinate < x0 ? last_below : last_above) = next->coordinate;
    nodes.stop[nodes.size++] = next;
  }
  add_own_images(own, nodes);
  return nodes;
}

/// First and second derivative with their noise.
struct Estimate {
  double first = 0.0;
  double first_noise2 = 0.0;
  double second = 0.0;
  double second_noise2 = 0.0;
  double own = 0.0;  ///< the derivative of as high an order as the polynomial's
  double own_noise2 = 0.0;
};

/// Derivatives at the first node of the polynomials through 1, 2, .. nodes; the first is a constant's.
/// Newton's form: P_p = P_(p-1) + y[x_0 .. x_p] prod_(m<p) (x - x_m), x_0 = 0, so that at 0
///   P_p' = P_(p-1)' + y[..] prod_(1<=m<p) (-x_m),
///   P_p'' = P_(p-1)'' + 2 y[..] sum_(1<=m<p) prod_(n != m) (-x_n),
/// and y[x_0 .. x_p] = sum_j y_j / prod_(m != j) (x_j - x_m).
std::array<Estimate, kNodesAtMost> estimates(const Nodes& nodes, const std::array<double, kNodesAtMost>& y,
                                             const std::array<double, kNodesAtMost>& u) {
  std::array<Estimate, kNodesAtMost> found{};
  std::array<double, kNodesAtMost> x{};
  std::array<double, kNodesAtMost> divided{1.0};
  std::array<double, kNodesAtMost> first{};
  std::array<double, kNodesAtMost> second{};
  double product = 1.0;     // of -x_m, 1 <= m < p
  double derivative = 0.0;  // sum over m of the products without m
  double factorial = 1.0;
  for (std::size_t p = 1; p < nodes.size; ++p) {
    x[p] = nodes.stop[p]->coordinate - nodes.stop[0]->coordinate;
    double own = 1.0;
    for (std::size_t j = 0; j < p; ++j) {
      divided[j] /= x[j] - x[p];
      own *= x[p] - x[j];
    }
    divided[p] = 1.0 / own;
    factorial *= static_cast<double>(p);
    Estimate& e = found[p];
    for (std::size_t j = 0; j <= p; ++j) {
      first[j] += product * divided[j];
      second[j] += 2.0 * derivative * divided[j];
      e.first += first[j] * y[j];
      e.second += second[j] * y[j];
      e.first_noise2 += first[j] * first[j] * u[j] * u[j];
      e.second_noise2 += second[j] * second[j] * u[j] * u[j];
      const double own_of_j = factorial * divided[j];
      e.own += own_of_j * y[j];
      e.own_noise2 += own_of_j * own_of_j * u[j] * u[j];
    }
    derivative = -x[p] * derivative + product;
    product *= -x[p];
  }
  return found;
}

struct Derivative {
  double value = 0.0;
  double missed = 0.0;
  double noise = 0.0;
  bool is_known = false;
};

// Of the orders from `lowest` on, the one whose noise and missed part are least. An order below `first` is no estimate
// of the derivative: beside a lowest one, which has none but higher ones to be held against, and half of it where it is
// the only one.
template <class Value, class Noise2>
Derivative best_of(std::size_t size, std::size_t lowest, std::size_t first, Value value, Noise2 noise2) {
  Derivative best;
  double least = INFINITY;
  for (std::size_t p = lowest; p < size; ++p) {
    double missed = p > first ? std::abs(value(p) - value(p - 1)) : p + 1 == size ? 0.5 * std::abs(value(p)) : 0.0;
    // Two orders may agree by accident, three hardly.
    for (std::size_t next = p + 1; next < std::min(size, p > first ? p + 2 : p + 3); ++next) {
      missed = std::max(missed, std::abs(value(next) - value(p)));
    }
    const double all = noise2(p) + missed * missed;
    if (all >= least) continue;
    least = all;
    best = {.value = value(p), .missed = missed, .noise = std::sqrt(noise2(p)), .is_known = true};
  }
  return best;
}

/// How a line bends on: what three points do not see.
struct LineBend {
  bool has_five = false;    ///< points: then both squares are known
  double third2 = 0.0;      ///< square of the third derivative of f (f g''' of ln f), noise taken off
  double fourth2 = 0.0;     ///< of the fourth
  bool is_lone = false;     ///< of three points: one second derivative, and nothing to hold it against
  double per_third = 0.0;   ///< of a lone line: what its second derivative misses for each unit of the third
  double per_fourth = 0.0;  ///< of the fourth
};
using LineBends = std::array<LineBend, kDirectionAxes>;

LineBend bend_of(const Nodes& nodes, const std::array<Estimate, kNodesAtMost>& e, double unit) {
  const auto square = [&](std::size_t p) { return unit * unit * (e[p].own * e[p].own - e[p].own_noise2); };
  LineBend bend{.has_five = nodes.size == kNodesAtMost, .is_lone = nodes.size == 3};
  if (bend.has_five) bend.third2 = std::max(0.0, square(3));
  if (bend.has_five) bend.fourth2 = std::max(0.0, square(4));
  if (!bend.is_lone) return bend;
  const double a = nodes.stop[1]->coordinate - nodes.stop[0]->coordinate;
  const double b = nodes.stop[2]->coordinate - nodes.stop[0]->coordinate;
  bend.per_third = std::abs(a + b) / 3.0;
  bend.per_fourth = (a * a + a * b + b * b) / 12.0;
  return bend;
}

void read_stop(std::span<const SlopeOrdinate> ordinates, const LineStop& own, std::size_t a, DirectionSlopes& slopes,
               LineBend& bend_on) {
  const Nodes nodes = nodes_about(own);
  std::array<double, kNodesAtMost> y{};
  std::array<double, kNodesAtMost> u{};
  bool has_logarithm = true;
  for (std::size_t n = 0; n < nodes.size; ++n) has_logarithm &= ordinates[nodes.stop[n]->point].has_logarithm;
  for (std::size_t n = 0; n < nodes.size; ++n) {
    const SlopeOrdinate& o = ordinates[nodes.stop[n]->point];
    y[n] = has_logarithm ? o.log_f : o.f;
    u[n] = has_logarithm ? o.u_log : o.u;
  }
  const double unit = has_logarithm ? ordinates[own.point].f : 1.0;
  const double bend = has_logarithm ? 1.0 : 0.0;  // f'' / f = g'' + g'^2
  const auto e = estimates(nodes, y, u);
  const Derivative first = best_of(
      nodes.size, 1, 0, [&](std::size_t p) { return e[p].first; }, [&](std::size_t p) { return e[p].first_noise2; });
  const Derivative second = best_of(
      nodes.size, 2, 2, [&](std::size_t p) { return e[p].second + bend * e[p].first * e[p].first; },
      [&](std::size_t p) { return e[p].second_noise2; });
  slopes.slope[a] = static_cast<double>(own.sign) * unit * first.value;
  slopes.unresolved[a] = unit * first.missed;
  slopes.has_neighbours[a] = first.is_known;
  slopes.curvature[a] = unit * second.value;
  slopes.unresolved_curvature[a] = second.is_known ? unit * second.missed : -1.0;  // guessed below
  slopes.curvature_noise[a] = unit * second.noise;
  bend_on = bend_of(nodes, e, unit);
}

// Where phi means nothing, or where the mirror plane makes the function even, its slope is 0 without any neighbour.
bool has_no_phi_slope(const Geometry& g, bool isotropic) {
  if (plan_key(g.theta_r) == 0) return true;
  if (!isotropic) return false;
  const std::int64_t d = plan_key(azimuth_between(g, true));
  return plan_key(g.theta_i) == 0 || d == 0 || d == 180000;
}

constexpr std::size_t kI = 0;
constexpr std::size_t kR = 1;
constexpr std::size_t kPhi = 2;

double smaller_sine(const Geometry& g) {
  return std::min(std::abs(std::sin(g.theta_i.si())), std::abs(std::sin(g.theta_r.si())));
}

// |sin(dphi)| of an isotropic sample: what vanishes in its mirror plane.
double off_plane(const Geometry& g, bool isotropic) {
  return isotropic ? std::abs(std::sin(azimuth_between(g, true).si())) : 1.0;
}

void guess_slopes(const SlopePoint& point, bool isotropic, DirectionSlopes& s) {
  const auto size = [&](std::size_t a) { return root_sum(s.slope[a], s.unresolved[a]); };
  if (!s.has_neighbours[kI] && !s.has_neighbours[kR]) {
    s.unresolved[kI] = s.unresolved[kR] = std::abs(point.value.si());
  } else if (!s.has_neighbours[kI]) {
    s.unresolved[kI] = size(kR);
  } else if (!s.has_neighbours[kR]) {
    s.unresolved[kR] = size(kI);
  }
  const double steepest = std::max(size(kI), size(kR));
  if (has_no_phi_slope(point.planned, isotropic)) {
    s.slope[kPhi] = s.unresolved[kPhi] = 0.0;
    s.has_neighbours[kPhi] = true;
  } else if (!s.has_neighbours[kPhi]) {
    s.unresolved[kPhi] = steepest * smaller_sine(point.reported);
  }
  s.across_pole.fill(steepest * off_plane(point.planned, isotropic));
}

// Of three points along phi: f as a function of m cos(dphi), whose derivatives are those along theta.
double missed_along_phi(const LineBend& lone, const LineBend& like, const SlopePoint& point, bool isotropic,
                        const DirectionSlopes& s) {
  const double m = smaller_sine(point.reported);
  const double first = m * std::max(std::abs(s.slope[kI]), std::abs(s.slope[kR]));
  const double second = m * m * std::max(std::abs(s.curvature[kI]), std::abs(s.curvature[kR]));
  const double third = m * m * m * std::sqrt(like.third2);
  const double fourth = m * m * m * m * std::sqrt(like.fourth2);
  const double odd = off_plane(point.reported, isotropic) * std::hypot(third, 3.0 * second, first);
  const double even = std::hypot(std::hypot(fourth, 6.0 * third), 4.0 * second, first);
  return std::hypot(lone.per_third * odd, lone.per_fourth * even);
}

void guess_lone_lines(const SlopePoint& point, bool isotropic, const LineBends& bends, DirectionSlopes& s) {
  const LineBend& like = bends[kR].has_five ? bends[kR] : bends[kI];
  if (!like.has_five) return;  // half of the derivative stands, as best_of has it
  for (const std::size_t a : {kI, kR}) {
    if (!bends[a].is_lone) continue;
    s.unresolved_curvature[a] =
        std::hypot(bends[a].per_third * std::sqrt(like.third2), bends[a].per_fourth * std::sqrt(like.fourth2));
  }
  if (bends[kPhi].is_lone) s.unresolved_curvature[kPhi] = missed_along_phi(bends[kPhi], like, point, isotropic, s);
}

// A lobe about any direction bends alike along both thetas.
void guess_curvatures(const SlopePoint& point, DirectionSlopes& s) {
  const auto is_known = [&](std::size_t a) { return s.unresolved_curvature[a] >= 0.0; };
  const std::array<bool, 2> known{is_known(kI), is_known(kR)};
  if (!known[0] && !known[1]) {
    const double f = std::abs(point.value.si());
    s.unresolved_curvature[kI] = s.unresolved_curvature[kR] =
        std::max({f, std::abs(s.slope[kI]), std::abs(s.slope[kR])});
  } else if (!known[0] || !known[1]) {
    const std::size_t unknown = known[0] ? kR : kI;
    const std::size_t other = known[0] ? kI : kR;
    s.curvature[unknown] = s.curvature[other];
    s.curvature_noise[unknown] = s.curvature_noise[other];
    s.unresolved_curvature[unknown] = std::hypot(s.unresolved_curvature[other], 0.5 * s.curvature[other]);
  }
  const bool is_even = plan_key(point.planned.theta_r) == 0 || plan_key(point.planned.theta_i) == 0;
  s.has_bend_along_phi = is_even || is_known(kPhi);
  if (is_even || !s.has_bend_along_phi) {
    s.curvature[kPhi] = s.unresolved_curvature[kPhi] = s.curvature_noise[kPhi] = 0.0;
  }
}

}  // namespace

SlopeField::SlopeField(std::span<const SlopePoint> points, bool isotropic, int threads)
    : points_(points), isotropic_(isotropic), ordinates_(points.size()) {
  constexpr std::size_t kPointsAtOnce = 4096;
  LargeArray<DirectionKey> keys(points.size());
  for_blocks((points.size() + kPointsAtOnce - 1) / kPointsAtOnce, threads, [&](std::size_t block) {
    const std::size_t last = std::min(points.size(), (block + 1) * kPointsAtOnce);
    for (std::size_t n = block * kPointsAtOnce; n < last; ++n) {
      keys[n] = direction_key(points[n], isotropic);
      ordinates_[n] = ordinate_of(points[n]);
    }
  });
  for_blocks(kDirectionAxes, threads, [&](std::size_t axis) {
    lines_[axis] = std::make_unique<DirectionLines>(points, keys, isotropic, static_cast<DirectionAxis>(axis));
  });
}

SlopeField::~SlopeField() = default;

DirectionSlopes SlopeField::at(std::size_t n) const {
  DirectionSlopes slopes;
  LineBends bends;
  for (std::size_t axis = 0; axis < kDirectionAxes; ++axis) {
    read_stop(ordinates_, lines_[axis]->stop_of(n), axis, slopes, bends[axis]);
  }
  guess_slopes(points_[n], isotropic_, slopes);
  guess_lone_lines(points_[n], isotropic_, bends, slopes);
  guess_curvatures(points_[n], slopes);
  return slopes;
}

}  // namespace gonio::calibration
