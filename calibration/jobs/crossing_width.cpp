#include "calibration/jobs/crossing_width.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

namespace gonio::calibration {

namespace {

constexpr std::size_t kLeastOnLine = 5;

using PlacesOnLine = std::vector<CrossingPlace>;  // ascending

Error no_width(std::string_view tried, std::string seen, std::string limit) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = std::string(tried),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

struct HalfPlace {
  std::size_t below = 0;  // the place before it on the line; the other is the next
  double at = 0.0;
};

struct Halves {
  HalfPlace left;
  HalfPlace right;
  double level = 0.0;
  [[nodiscard]] double middle() const { return 0.5 * (left.at + right.at); }
};

HalfPlace half_between(const PlacesOnLine& line, std::size_t below, double half) {
  const CrossingPlace& a = line[below];
  const CrossingPlace& b = line[below + 1];
  return {.below = below, .at = a.at + (half - a.q) / (b.q - a.q) * (b.at - a.at)};
}

double level_at(const PlacesOnLine& line, double at) {
  const auto after =
      std::ranges::find_if(line.begin() + 1, line.end() - 1, [&](const CrossingPlace& p) { return p.at >= at; });
  const CrossingPlace& b = *after;
  const CrossingPlace& a = *(after - 1);
  return a.q + (at - a.at) / (b.at - a.at) * (b.q - a.q);
}

// From the brightest place outwards to the first that is darker than half of the level; none: it never is.
std::optional<Halves> halves_of(const PlacesOnLine& line, double level) {
  const double half = 0.5 * level;
  const auto top = static_cast<std::size_t>(std::ranges::max_element(line, {}, &CrossingPlace::q) - line.begin());
  std::size_t left = top;
  while (left > 0 && line[left].q >= half) --left;
  std::size_t right = top;
  while (right + 1 < line.size() && line[right].q >= half) ++right;
  if (line[left].q >= half || line[right].q >= half || left == top) return std::nullopt;
  return Halves{.left = half_between(line, left, half), .right = half_between(line, right - 1, half), .level = level};
}

std::optional<Halves> settled_halves(const PlacesOnLine& line) {
  constexpr int kRounds = 4;
  auto halves = halves_of(line, std::ranges::max(line, {}, &CrossingPlace::q).q);
  for (int round = 0; round < kRounds && halves; ++round) halves = halves_of(line, level_at(line, halves->middle()));
  return halves;
}

// Of q by the angle, from the places on both sides.
double slope_at(const PlacesOnLine& line, std::size_t k) {
  const CrossingPlace& before = line[k == 0 ? 0 : k - 1];
  const CrossingPlace& after = line[std::min(k + 1, line.size() - 1)];
  return (after.q - before.q) / (after.at - before.at);
}

// How far a half-level place may lie off the line between its two readings: an eighth of the second difference there,
// as an angle, at most.
double bend_at(const PlacesOnLine& line, const HalfPlace& half) {
  const auto second = [&](std::size_t k) {
    if (k == 0 || k + 1 >= line.size()) return 0.0;
    return std::abs(line[k + 1].q - 2.0 * line[k].q + line[k - 1].q);
  };
  const CrossingPlace& a = line[half.below];
  const CrossingPlace& b = line[half.below + 1];
  const double bend = 0.5 * (second(half.below) + second(half.below + 1)) / 8.0;
  return bend / std::abs(b.q - a.q) * (b.at - a.at);
}

Result<void> check_ends(const PlacesOnLine& line, double level, std::string_view tried) {
  constexpr double kAtMost = 0.1;
  const CrossingPlace& brighter = line.front().q > line.back().q ? line.front() : line.back();
  const double share = brighter.q / level;
  if (share <= kAtMost) return {};
  return failure(
      no_width(tried, fmt::format("still {:.2f} of the middle at the edge", share), "0.1: widen half_width_deg"));
}

Result<void> check_flanks(const PlacesOnLine& line, const Halves& halves, std::string_view tried) {
  constexpr double kFoot = 0.05;
  constexpr double kTop = 0.95;
  constexpr std::ptrdiff_t kLeast = 3;
  const auto on_flank = [&](bool is_left) {
    return std::ranges::count_if(line, [&](const CrossingPlace& p) {
      const double share = p.q / halves.level;
      return (p.at < halves.middle()) == is_left && share > kFoot && share < kTop;
    });
  };
  const std::ptrdiff_t fewest = std::min(on_flank(true), on_flank(false));
  if (fewest >= kLeast) return {};
  return failure(no_width(tried, fmt::format("{} places on a flank, between 5 % and 95 % of the middle", fewest),
                          fmt::format("{} at least: a smaller step_deg", kLeast)));
}

Result<Halves> checked_halves(const PlacesOnLine& line, std::string_view tried) {
  if (line.size() < kLeastOnLine) {
    return failure(no_width(tried, fmt::format("{} places", line.size()), fmt::format("{} at least", kLeastOnLine)));
  }
  constexpr double kClear = 10.0;  // standard deviations: below, a half level is no place
  const CrossingPlace top = std::ranges::max(line, {}, &CrossingPlace::q);
  if (!(top.q > kClear * top.u)) {
    return failure(no_width(tried, "no light: the brightest place is not clear of its noise",
                            fmt::format("{:g} times the noise", kClear)));
  }
  GONIO_TRY(check_ends(line, top.q, tried));
  const std::optional<Halves> halves = settled_halves(line);
  if (!halves) return failure(no_width(tried, "no half level on both sides of the brightest place", "one on each"));
  GONIO_TRY(check_flanks(line, *halves, tried));
  return *halves;
}

struct WidthSlopes {
  double of_width = 0.0;
  double of_centre = 0.0;
};

// d width / dq and d centre / dq of one place, by a step of its own noise both ways.
WidthSlopes slopes_by(PlacesOnLine line, std::size_t k, double step) {
  const double q = line[k].q;
  line[k].q = q + step;
  const auto more = settled_halves(line);
  line[k].q = q - step;
  const auto less = settled_halves(line);
  if (!more || !less || !(step > 0.0)) return {};
  const double left = (more->left.at - less->left.at) / (2.0 * step);
  const double right = (more->right.at - less->right.at) / (2.0 * step);
  return {.of_width = right - left, .of_centre = 0.5 * (left + right)};
}

}  // namespace

Result<CrossingWidth> crossing_width(std::span<const CrossingPlace> places, Angle u_pointing, std::string_view tried) {
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return places[k].at; });
  PlacesOnLine line;
  for (const std::size_t k : order) line.push_back(places[k]);
  const Result<Halves> halves = checked_halves(line, tried);
  if (!halves) return failure(halves.error());

  CrossingWidth found{.level = halves->level,
                      .dwidth_dq = std::vector<double>(places.size()),
                      .dcentre_dq = std::vector<double>(places.size())};
  const double bends = std::hypot(bend_at(line, halves->left), bend_at(line, halves->right)) / std::numbers::sqrt3;
  double width_variance = bends * bends;
  double centre_variance = 0.25 * bends * bends;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const double u = std::hypot(line[k].u, slope_at(line, k) * in_radians(u_pointing));
    const WidthSlopes by = slopes_by(line, k, line[k].u);
    width_variance += std::pow(by.of_width * u, 2);
    centre_variance += std::pow(by.of_centre * u, 2);
    found.dwidth_dq[order[k]] = by.of_width;
    found.dcentre_dq[order[k]] = by.of_centre;
  }
  found.width = {radians(halves->right.at - halves->left.at), radians(std::sqrt(width_variance))};
  found.centre = {radians(halves->middle()), radians(std::sqrt(centre_variance))};
  return found;
}

}  // namespace gonio::calibration
