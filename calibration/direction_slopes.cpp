#include "calibration/direction_slopes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/direction_lines.h"
#include "calibration/line_derivatives.h"
#include "calibration/nearby_secants.h"
#include "calibration/parallel_blocks.h"
#include "calibration/root_sum.h"

namespace gonio::calibration {
namespace {

constexpr double kSamePlace = 2e-4;  // 0.01 deg: closer neighbours give noise over nothing
constexpr std::size_t kNodesAtMost = LineNodes::kAtMost;
constexpr std::size_t kI = 0;
constexpr std::size_t kR = 1;
constexpr std::size_t kPhi = 2;
constexpr std::size_t kCosine = kDirectionAxes;  // a lane of its own: the line along phi once more
static_assert(kCosine < kLineLanes);

SlopeOrdinate ordinate_of(const SlopePoint& p) {
  constexpr double kClearOfZero = 5.0;  // standard uncertainties: then ln f is normal too
  const double f = p.value.si();
  const double u = p.u_random.si();
  SlopeOrdinate ordinate{.cos_dphi = std::cos((p.reported.phi_r - p.reported.phi_i).si())};
  if (!(f > kClearOfZero * u && f > 0.0)) return ordinate;
  ordinate.log_f = std::log(f);
  ordinate.u_log = u / f;
  return ordinate;
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
  if (nodes.size < kNodesAtMost) add_own_images(own, nodes);
  return nodes;
}

/// The lines through a point, an axis a lane.
struct PointLines {
  LineNodes nodes;
  std::array<double, kDirectionAxes> unit{};  ///< of a derivative: f of a line through ln f
  std::array<double, kDirectionAxes> sign{};
  std::array<double, kNodesAtMost> cos_dphi{};  ///< of the nodes along phi
  LineDerivatives found;

  [[nodiscard]] std::size_t size(std::size_t axis) const { return static_cast<std::size_t>(nodes.size[axis]); }
};

void read_line(std::span<const SlopePoint> points, std::span<const SlopeOrdinate> ordinates, const LineStop& own,
               std::size_t axis, PointLines& lines) {
  const Nodes near = nodes_about(own);
  bool has_logarithm = true;
  for (std::size_t n = 0; n < near.size; ++n) {
    const SlopeOrdinate& o = ordinates[near.stop[n]->point];
    has_logarithm &= o.has_logarithm();
    lines.nodes.x[n][axis] = near.stop[n]->coordinate - own.coordinate;
    lines.nodes.y[n][axis] = o.log_f;
    lines.nodes.u2[n][axis] = o.u_log * o.u_log;
    if (axis == kPhi) lines.cos_dphi[n] = o.cos_dphi;
  }
  for (std::size_t n = 0; n < near.size && !has_logarithm; ++n) {
    const SlopePoint& p = points[near.stop[n]->point];
    lines.nodes.y[n][axis] = p.value.si();
    lines.nodes.u2[n][axis] = p.u_random.si() * p.u_random.si();
  }
  lines.nodes.size[axis] = static_cast<double>(near.size);
  lines.nodes.is_logarithm[axis] = has_logarithm ? 1.0 : 0.0;
  lines.unit[axis] = has_logarithm ? points[own.point].value.si() : 1.0;
  lines.sign[axis] = static_cast<double>(own.sign);
}

constexpr std::size_t kOfLoneLine = 3;

// An isotropic sample's line along phi by x = -cos(dphi), in which both of its mirror planes are kept: an image is its
// point. Nearest first, as x counts. Fewer than three points say less than the images do.
void add_cosines(PointLines& lines) {
  constexpr double kSameCosine = 1e-6;
  LineNodes& nodes = lines.nodes;
  std::size_t size = 0;
  for (std::size_t n = 0; n < lines.size(kPhi); ++n) {
    const double x = lines.cos_dphi[0] - lines.cos_dphi[n];
    bool is_image = false;
    for (std::size_t m = 0; m < size; ++m) is_image |= std::abs(nodes.x[m][kCosine] - x) < kSameCosine;
    if (is_image) continue;
    std::size_t place = size++;
    for (; place > 0 && std::abs(nodes.x[place - 1][kCosine]) > std::abs(x); --place) {
      nodes.x[place][kCosine] = nodes.x[place - 1][kCosine];
      nodes.y[place][kCosine] = nodes.y[place - 1][kCosine];
      nodes.u2[place][kCosine] = nodes.u2[place - 1][kCosine];
    }
    nodes.x[place][kCosine] = x;
    nodes.y[place][kCosine] = nodes.y[n][kPhi];
    nodes.u2[place][kCosine] = nodes.u2[n][kPhi];
  }
  nodes.size[kCosine] = size >= kOfLoneLine ? static_cast<double>(size) : 0.0;
  nodes.is_logarithm[kCosine] = nodes.is_logarithm[kPhi];
}

// d/dphi = sin(dphi) d/dx.
void take_cosines(const PointLines& lines, DirectionSlopes& slopes) {
  if (lines.size(kCosine) < kOfLoneLine) return;
  const double cosine = lines.cos_dphi[0];
  const double per_x = lines.unit[kPhi] * std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  slopes.slope[kPhi] = lines.sign[kPhi] * per_x * lines.found.first[kCosine];
  slopes.unresolved[kPhi] = per_x * lines.found.first_missed[kCosine];
}

DirectionSlopes slopes_of(const PointLines& lines) {
  DirectionSlopes slopes;
  for (std::size_t a = 0; a < kDirectionAxes; ++a) {
    const double unit = lines.unit[a];
    slopes.slope[a] = lines.sign[a] * unit * lines.found.first[a];
    slopes.unresolved[a] = unit * lines.found.first_missed[a];
    slopes.has_neighbours[a] = lines.size(a) > 1;
    slopes.curvature[a] = unit * lines.found.second[a];
    slopes.unresolved_curvature[a] = lines.size(a) > 2 ? unit * lines.found.second_missed[a] : -1.0;  // guessed below
    slopes.curvature_noise[a] = unit * std::sqrt(lines.found.second_noise2[a]);
  }
  return slopes;
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

LineBend bend_of(const PointLines& lines, std::size_t axis) {
  const double unit2 = lines.unit[axis] * lines.unit[axis];
  const double a = lines.nodes.x[1][axis];
  const double b = lines.nodes.x[2][axis];
  return {.has_five = lines.size(axis) == kNodesAtMost,
          .third2 = unit2 * lines.found.third2[axis],
          .fourth2 = unit2 * lines.found.fourth2[axis],
          .is_lone = lines.size(axis) == kOfLoneLine,
          .per_third = std::abs(a + b) / 3.0,
          .per_fourth = (a * a + a * b + b * b) / 12.0};
}

// Where phi means nothing, or where the mirror plane makes the function even, its slope is 0 without any neighbour.
bool has_no_phi_slope(const DirectionKey& key, bool isotropic) {
  constexpr std::int32_t kHalfTurn = 180000;
  if (key.theta_r == 0) return true;
  if (!isotropic) return false;
  return key.theta_i == 0 || key.dphi == 0 || key.dphi == kHalfTurn;
}

double smaller_sine(const Geometry& g) {
  return std::min(std::abs(std::sin(g.theta_i.si())), std::abs(std::sin(g.theta_r.si())));
}

// |sin(dphi)| of an isotropic sample: what vanishes in its mirror plane.
double off_plane(const Geometry& g, bool isotropic) {
  return isotropic ? std::abs(std::sin(azimuth_between(g, true).si())) : 1.0;
}

// Across a pole f changes towards the other direction; elsewhere nobody asks.
bool is_near_pole(const DirectionKey& key) {
  constexpr std::int32_t kNear = 10000;  // 10 deg in 0.001 deg: further than any mounting turns a surface
  return std::min(std::abs(key.theta_i), std::abs(key.theta_r)) < kNear;
}

// `nearby`: the steepest secant of a point without a neighbour along either theta (nearby_secants.h).
void guess_slopes(const SlopePoint& point, const DirectionKey& key, bool isotropic, double nearby, DirectionSlopes& s) {
  const auto size = [&](std::size_t a) { return root_sum(s.slope[a], s.unresolved[a]); };
  if (!s.has_neighbours[kI] && !s.has_neighbours[kR]) {
    s.unresolved[kI] = s.unresolved[kR] = std::max(std::abs(point.value.si()), nearby);
  } else if (!s.has_neighbours[kI]) {
    s.unresolved[kI] = size(kR);
  } else if (!s.has_neighbours[kR]) {
    s.unresolved[kR] = size(kI);
  }
  const double steepest = std::max(size(kI), size(kR));
  if (has_no_phi_slope(key, isotropic)) {
    s.slope[kPhi] = s.unresolved[kPhi] = 0.0;
    s.has_neighbours[kPhi] = true;
  } else if (!s.has_neighbours[kPhi]) {
    s.unresolved[kPhi] = steepest * smaller_sine(point.reported);
  }
  if (is_near_pole(key)) s.across_pole.fill(steepest * off_plane(point.planned, isotropic));
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

void guess_lone_lines(const SlopePoint& point, bool isotropic, const PointLines& lines, DirectionSlopes& s) {
  const bool has_lone =
      lines.size(kI) == kOfLoneLine || lines.size(kR) == kOfLoneLine || lines.size(kPhi) == kOfLoneLine;
  if (!has_lone) return;
  const LineBends bends{bend_of(lines, kI), bend_of(lines, kR), bend_of(lines, kPhi)};
  const LineBend& like = bends[kR].has_five ? bends[kR] : bends[kI];
  if (!like.has_five) return;  // half of the derivative stands
  for (const std::size_t a : {kI, kR}) {
    if (!bends[a].is_lone) continue;
    s.unresolved_curvature[a] =
        std::hypot(bends[a].per_third * std::sqrt(like.third2), bends[a].per_fourth * std::sqrt(like.fourth2));
  }
  if (bends[kPhi].is_lone) s.unresolved_curvature[kPhi] = missed_along_phi(bends[kPhi], like, point, isotropic, s);
}

// A lobe about any direction bends alike along both thetas.
void guess_curvatures(const SlopePoint& point, const DirectionKey& key, DirectionSlopes& s) {
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
  const bool is_even = key.theta_r == 0 || key.theta_i == 0;
  s.has_bend_along_phi = is_even || is_known(kPhi);
  if (is_even || !s.has_bend_along_phi) {
    s.curvature[kPhi] = s.unresolved_curvature[kPhi] = s.curvature_noise[kPhi] = 0.0;
  }
}

}  // namespace

SlopeField::SlopeField(std::span<const SlopePoint> points, bool isotropic, int threads)
    : points_(points), isotropic_(isotropic), keys_(points.size()), ordinates_(points.size()) {
  constexpr std::size_t kPointsAtOnce = 4096;
  for_blocks((points.size() + kPointsAtOnce - 1) / kPointsAtOnce, threads, [&](std::size_t block) {
    const std::size_t last = std::min(points.size(), (block + 1) * kPointsAtOnce);
    for (std::size_t n = block * kPointsAtOnce; n < last; ++n) {
      keys_[n] = direction_key(points[n], isotropic);
      ordinates_[n] = ordinate_of(points[n]);
    }
  });
  for_blocks(kDirectionAxes, threads, [&](std::size_t axis) {
    lines_[axis] = std::make_unique<DirectionLines>(points, keys_, isotropic, static_cast<DirectionAxis>(axis));
  });
  nearby_ = std::make_unique<NearbySecants>(points_, ordinates_, isotropic_);
}

SlopeField::~SlopeField() = default;

DirectionSlopes SlopeField::at(std::size_t n) const {
  PointLines lines;
  for (std::size_t axis = 0; axis < kDirectionAxes; ++axis) {
    read_line(points_, ordinates_, lines_[axis]->stop_of(n), axis, lines);
  }
  if (isotropic_) add_cosines(lines);
  differentiate(lines.nodes, lines.found);
  DirectionSlopes slopes = slopes_of(lines);
  if (isotropic_) take_cosines(lines, slopes);
  const bool is_lone = !slopes.has_neighbours[kI] && !slopes.has_neighbours[kR];
  guess_slopes(points_[n], keys_[n], isotropic_, is_lone ? nearby_->steepest(n) : 0.0, slopes);
  guess_lone_lines(points_[n], isotropic_, lines, slopes);
  guess_curvatures(points_[n], keys_[n], slopes);
  return slopes;
}

}  // namespace gonio::calibration
