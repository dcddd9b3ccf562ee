#include "calibration/jobs/even_beam.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "calibration/jobs/least_squares.h"

namespace gonio::calibration {

namespace {

enum BeamParameter : std::size_t { kLevel, kFloor, kX, kY, kBeam, kStop, kDistance, kBeamParameters };
using BeamValues = std::array<double, kBeamParameters>;  // q, rad, mm

// What two discs have in common, and how it follows their distance and radii: by the arcs that bound it.
struct CommonArea {
  double area = 0.0;
  double by_distance = 0.0;
  double by_a = 0.0;
  double by_b = 0.0;
};

CommonArea common_area(double distance, double a, double b) {
  constexpr double kPi = std::numbers::pi;
  if (distance >= a + b) return {};
  if (distance <= std::abs(a - b)) {
    const bool is_a = a < b;
    const double r = std::min(a, b);
    return {.area = kPi * r * r, .by_a = is_a ? 2.0 * kPi * r : 0.0, .by_b = is_a ? 0.0 : 2.0 * kPi * r};
  }
  const double to_chord = (distance * distance + a * a - b * b) / (2.0 * distance);  // from the centre of a
  const double alpha = std::acos(std::clamp(to_chord / a, -1.0, 1.0));
  const double beta = std::acos(std::clamp((distance - to_chord) / b, -1.0, 1.0));
  const double half_chord = a * std::sin(alpha);
  return {.area = a * a * alpha + b * b * beta - distance * half_chord,
          .by_distance = -2.0 * half_chord,
          .by_a = 2.0 * a * alpha,
          .by_b = 2.0 * b * beta};
}

struct Foreseen {
  double q = 0.0;
  BeamValues slopes{};
};

Foreseen foreseen(const BeamValues& p, double x, double y) {
  const double dx = x - p[kX];
  const double dy = y - p[kY];
  const double off = std::hypot(dx, dy);
  const double tangent = std::tan(off);
  const CommonArea common = common_area(p[kDistance] * tangent, p[kStop], p[kBeam]);
  const double whole = std::numbers::pi * p[kBeam] * p[kBeam];
  const double scale = p[kLevel] / whole;
  Foreseen seen{.q = p[kFloor] + scale * common.area};
  seen.slopes[kLevel] = common.area / whole;
  seen.slopes[kFloor] = 1.0;
  if (off > 0.0) {
    const double by_off = scale * common.by_distance * p[kDistance] * (1.0 + tangent * tangent);
    seen.slopes[kX] = -by_off * dx / off;
    seen.slopes[kY] = -by_off * dy / off;
  }
  seen.slopes[kBeam] = scale * (common.by_b - 2.0 * common.area / p[kBeam]);
  seen.slopes[kStop] = scale * common.by_a;
  seen.slopes[kDistance] = scale * common.by_distance * tangent;
  return seen;
}

// The level that fits best with these radii, all places alike, and what is left.
double left_of_level(std::span<const BeamPlace> places, BeamValues& p) {
  double shares = 0.0;
  double seen = 0.0;
  p[kLevel] = 1.0;
  for (const BeamPlace& place : places) {
    const double share = foreseen(p, place.x, place.y).q;
    shares += share * share;
    seen += share * place.q;
  }
  p[kLevel] = shares > 0.0 ? seen / shares : 0.0;
  double left = 0.0;
  for (const BeamPlace& place : places) left += std::pow(place.q - foreseen(p, place.x, place.y).q, 2);
  return left;
}

// The best of a ladder of radii: from far below the stop's to beyond all that the crossings show.
BeamValues begin_with(std::span<const BeamPlace> places, const BeamValues& stated, Angle half_width) {
  constexpr int kRungs = 60;
  constexpr double kSmallest = 0.02;
  const double largest = 2.0 * std::max(stated[kStop], stated[kDistance] * std::tan(in_radians(half_width)));
  double q = 0.0;
  BeamValues centred = stated;
  for (const BeamPlace& place : places) {
    const double light = std::max(0.0, place.q);
    q += light;
    centred[kX] += light * place.x;
    centred[kY] += light * place.y;
  }
  if (q > 0.0) {
    centred[kX] /= q;
    centred[kY] /= q;
  }
  BeamValues best = centred;
  double least = std::numeric_limits<double>::infinity();
  for (int rung = 0; rung <= kRungs; ++rung) {
    BeamValues tried = centred;
    tried[kBeam] = largest * std::pow(kSmallest, 1.0 - static_cast<double>(rung) / kRungs);
    const double left = left_of_level(places, tried);
    if (left < least) {
      least = left;
      best = tried;
    }
  }
  return best;
}

// What each place's q may be off by: its noise, and the pointing's error. At the foot and at the shoulder the slope
// changes within that error: so by the mean square of what a normal error makes (Gauss and Hermite, five nodes).
std::vector<double> doubts_at(const BeamValues& p, std::span<const BeamPlace> places, Angle u_pointing) {
  struct Node {
    double at = 0.0;  // standard deviations
    double weight = 0.0;
  };
  constexpr std::array<Node, 4> kNodes{{{1.355626179974266, 0.222075922005613},
                                        {-1.355626179974266, 0.222075922005613},
                                        {2.856970013872806, 0.011257411327721},
                                        {-2.856970013872806, 0.011257411327721}}};
  constexpr double kOnAxis = 1e-12;  // rad
  std::vector<double> doubts;
  for (const BeamPlace& place : places) {
    const double dx = place.x - p[kX];
    const double dy = place.y - p[kY];
    const double part = in_radians(u_pointing) / std::max(kOnAxis, std::hypot(dx, dy));
    const double q = foreseen(p, place.x, place.y).q;
    double variance = place.u * place.u;
    for (const Node& node : kNodes) {
      const double there = foreseen(p, place.x + node.at * part * dx, place.y + node.at * part * dy).q;
      variance += node.weight * (there - q) * (there - q);
    }
    doubts.push_back(std::sqrt(variance));
  }
  return doubts;
}

struct Problem {
  std::span<const BeamPlace> places;
  std::vector<double> doubts;
  BeamValues stated{};    // stop and distance
  BeamValues u_stated{};  // likewise
};

struct Round {
  LeastSquares squares{kBeamParameters};
  std::vector<BeamValues> rows;  // over the doubt
};

Round round_at(const BeamValues& p, const Problem& problem) {
  std::array<std::size_t, kBeamParameters> all{};
  std::iota(all.begin(), all.end(), std::size_t{0});
  Round round;
  for (std::size_t k = 0; k < problem.places.size(); ++k) {
    const BeamPlace& place = problem.places[k];
    const double u = problem.doubts[k];
    Foreseen seen = foreseen(p, place.x, place.y);
    for (double& slope : seen.slopes) slope /= u;
    round.squares.add((place.q - seen.q) / u, all, seen.slopes);
    round.rows.push_back(seen.slopes);
  }
  for (const std::size_t prior : {kStop, kDistance}) {
    const double slope = 1.0 / problem.u_stated[prior];
    round.squares.add((problem.stated[prior] - p[prior]) * slope, std::span(&prior, 1), std::span(&slope, 1));
  }
  return round;
}

// Goes along the step as far as the sum of squares falls, at most a part of the radius; false: nowhere by as much as a
// hundredth of a standard deviation is worth.
bool take(const LeastSquares::Step& step, const Problem& problem, double squares, BeamValues& p) {
  constexpr double kFarthest = 0.3;  // of the radius
  constexpr int kHalvings = 12;
  constexpr double kWorthIt = 1e-4;
  double part = 1.0 / std::max(1.0, std::abs(step.change[kBeam]) / (kFarthest * p[kBeam]));
  for (int halving = 0; halving < kHalvings; ++halving, part *= 0.5) {
    BeamValues there = p;
    for (std::size_t k = 0; k < kBeamParameters; ++k) there[k] += part * step.change[k];
    if (!(round_at(there, problem).squares.sum_of_squares() < squares - kWorthIt)) continue;
    p = there;
    return true;
  }
  return false;
}

bool is_settled(const LeastSquares::Step& step) {
  constexpr double kOfU = 1e-3;
  for (std::size_t k = 0; k < kBeamParameters; ++k) {
    if (std::abs(step.change[k]) > kOfU * std::sqrt(step.covariance[k * kBeamParameters + k])) return false;
  }
  return true;
}

// To the least sum of squares with these doubts. A kink of the model, where one disc just touches the other from
// within, may hold it there: then no step leads lower.
Result<LeastSquares::Step> settled_step(const Problem& problem, BeamValues& p) {
  constexpr int kRounds = 100;
  for (int round = 0; round < kRounds; ++round) {
    const Round here = round_at(p, problem);
    Result<LeastSquares::Step> step = here.squares.solve();
    if (!step || is_settled(*step) || !take(*step, problem, here.squares.sum_of_squares(), p)) return step;
  }
  return failure({.code = ErrorCode::IncompleteData,
                  .tried = "fit an even round beam",
                  .seen = fmt::format("no rest after {} rounds, at a radius of {:.4g} mm", kRounds, p[kBeam]),
                  .limit = "crossings of a beam and a stop that are round"});
}

EvenBeam even_beam_of(const BeamValues& p, const Problem& problem, const LeastSquares::Step& step) {
  constexpr std::size_t kOwnParameters = 5;  // stop and distance bring a row each
  const Round here = round_at(p, problem);
  EvenBeam beam{
      .radius = {millimetres(p[kBeam]), millimetres(std::sqrt(step.covariance[kBeam * kBeamParameters + kBeam]))},
      .chi2 = here.squares.sum_of_squares(),
      .degrees_of_freedom = static_cast<double>(here.rows.size()) - kOwnParameters};
  for (std::size_t k = 0; k < here.rows.size(); ++k) {
    double gain = 0.0;
    for (std::size_t j = 0; j < kBeamParameters; ++j)
      gain += step.covariance[kBeam * kBeamParameters + j] * here.rows[k][j];
    beam.dradius_dq.push_back(millimetres(gain / problem.doubts[k]).si());
  }
  return beam;
}

}  // namespace

Result<EvenBeam> fit_even_beam(std::span<const BeamPlace> places, const RoundStop& stop, Angle u_pointing,
                               Angle half_width) {
  constexpr double kSurelyKnown = 1e-7;  // mm
  constexpr int kPasses = 5;             // each with the doubts of the one before
  Problem problem{.places = places};
  problem.stated[kStop] = in_millimetres(stop.radius.value);
  problem.stated[kDistance] = in_millimetres(stop.distance.value);
  problem.u_stated[kStop] = std::max(kSurelyKnown, in_millimetres(stop.radius.u));
  problem.u_stated[kDistance] = std::max(kSurelyKnown, in_millimetres(stop.distance.u));
  BeamValues p = begin_with(places, problem.stated, half_width);
  for (int pass = 1;; ++pass) {
    problem.doubts = doubts_at(p, places, u_pointing);
    const Result<LeastSquares::Step> step = settled_step(problem, p);
    if (!step) return failure(step.error());
    if (pass == kPasses) return even_beam_of(p, problem, *step);
  }
}

}  // namespace gonio::calibration
