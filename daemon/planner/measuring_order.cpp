#include "daemon/planner/measuring_order.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <numeric>
#include <utility>

#include "daemon/planner/chance.h"
#include "daemon/planner/estimate.h"
#include "daemon/planner/neighbours.h"
#include "daemon/planner/planner.h"
#include "daemon/planner/snake.h"
#include "daemon/planner/tour_search.h"

namespace gonio::daemon {

namespace {

// A search takes seconds for so many points; beyond, the boustrophedon stands.
constexpr std::size_t kMostSearched = 200'000;
constexpr std::size_t kNeighbours = 10;
// So many kicks a place bring a thousand places to a few per mille of the bound in half a second; beyond, more of them
// gain little and a check of a plan would wait.
constexpr std::int64_t kKicksPerPlace = 20;
constexpr std::int64_t kMostKicks = 50'000;
// A way that depends on where it comes from changes with the order; after so many rounds the best is taken.
constexpr int kRounds = 2;

std::vector<std::int32_t> as_written(std::span<const ScanPoint> points) {
  std::vector<std::int32_t> order;
  for (const ScanPoint& point : points) {
    if (!point.blocked) order.push_back(point.index);
  }
  return order;
}

void shuffle(std::vector<std::int32_t>& order, std::uint64_t seed) {
  Chance chance(seed);
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[chance.below(k)]);
}

Place place_of(const ScanPoint& point, const Instrument& instrument, const Place& standing) {
  const auto target = axis_targets(point.geometry, point.wavelength, instrument, standing);
  assert(target);  // the planner has checked every direction
  Place place = standing;
  for (std::size_t a = 0; a < place.size(); ++a) place[a] = (*target)[a].value_or(place[a]);
  return place;
}

// Home, then every point of `order` as it is reached from home.
std::vector<Place> places_from_home(const Instrument& instrument, std::span<const ScanPoint> points,
                                    std::span<const std::int32_t> order) {
  std::vector<Place> places{home_position(instrument)};
  for (const std::int32_t index : order) {
    places.push_back(place_of(points[static_cast<std::size_t>(index)], instrument, places.front()));
  }
  return places;
}

// Points at which the axes stand alike are one place: they are measured one after the other.
class Sites {
 public:
  Sites(std::span<const Place> places, std::span<const std::int32_t> order) {
    places_.push_back(places.front());
    points_.emplace_back();
    std::map<Place, std::size_t> known;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto [at, is_new] = known.try_emplace(places[k + 1], places_.size());
      if (is_new) {
        places_.push_back(places[k + 1]);
        points_.emplace_back();
      }
      points_[at->second].push_back(order[k]);
    }
  }

  [[nodiscard]] std::span<const Place> places() const { return places_; }
  [[nodiscard]] std::vector<std::int32_t> order_of(std::span<const std::int32_t> walk) const {
    std::vector<std::int32_t> order;
    for (const std::int32_t site : walk) {
      const auto& points = points_[static_cast<std::size_t>(site)];
      order.insert(order.end(), points.begin(), points.end());
    }
    return order;
  }

 private:
  std::vector<Place> places_;  // home first
  std::vector<std::vector<std::int32_t>> points_;
};

std::vector<std::int32_t> searched_walk(std::span<const Place> places, const StepPrice& price,
                                        std::span<const std::int32_t> snake) {
  const Neighbours neighbours(places, price, kNeighbours);
  auto from_snake = shorten(places, price, neighbours, snake, 0);
  auto from_greedy = shorten(places, price, neighbours, greedy_walk(places, neighbours), 0);
  const bool is_snake_best = walk_s(places, from_snake, price) <= walk_s(places, from_greedy, price);
  const std::int64_t kicks = std::min(kMostKicks, kKicksPerPlace * std::ssize(snake));
  return shorten(places, price, neighbours, is_snake_best ? from_snake : from_greedy, kicks);
}

class Contest {
 public:
  Contest(const api::Plan& plan, const Instrument& instrument, std::span<const ScanPoint> points,
          const TimeExperience& experience)
      : plan_(plan), instrument_(instrument), points_(points), experience_(experience) {}

  void enter(std::vector<std::int32_t> order) {
    const auto time = estimate(plan_, instrument_, points_, order, experience_);
    if (!time) {
      if (!best_) best_ = failure(time.error());
      return;
    }
    if (!best_ || time->total() < best_->time.total()) best_ = MeasuringOrder{std::move(order), *time};
  }
  [[nodiscard]] Result<MeasuringOrder> best() && { return std::move(best_); }
  [[nodiscard]] bool has_one() const { return best_.has_value(); }

 private:
  const api::Plan& plan_;
  const Instrument& instrument_;
  std::span<const ScanPoint> points_;
  const TimeExperience& experience_;
  Result<MeasuringOrder> best_ = failure(Error{});
};

// The ways of some stages depend on where they come from: priced again with the ways that the walk found.
void enter_searched(Contest& contest, const Instrument& instrument, std::span<const ScanPoint> points,
                    std::vector<std::int32_t> order, std::vector<Place> places) {
  for (int round = 0; round < kRounds; ++round) {
    const Sites sites(places, order);
    const StepPrice price(instrument, sites.places());
    const auto walk = searched_walk(sites.places(), price, best_snake(sites.places(), price));
    std::vector<std::int32_t> found = sites.order_of(walk);
    std::vector<Place> walked = places_along(instrument, points, found);
    contest.enter(found);
    std::map<std::int32_t, std::size_t> was;
    bool is_same = true;
    for (std::size_t k = 0; k < order.size(); ++k) was[order[k]] = k + 1;
    for (std::size_t k = 0; k < found.size(); ++k) is_same = is_same && walked[k + 1] == places[was[found[k]]];
    if (is_same) return;
    order = std::move(found);
    places = std::move(walked);
  }
}

}  // namespace

std::vector<Place> places_along(const Instrument& instrument, std::span<const ScanPoint> points,
                                std::span<const std::int32_t> order) {
  std::vector<Place> places{home_position(instrument)};
  for (const std::int32_t index : order) {
    places.push_back(place_of(points[static_cast<std::size_t>(index)], instrument, places.back()));
  }
  return places;
}

std::vector<std::int32_t> snaked_order(const Instrument& instrument, std::span<const ScanPoint> points) {
  const std::vector<std::int32_t> written = as_written(points);
  const Sites sites(places_from_home(instrument, points, written), written);
  return sites.order_of(best_snake(sites.places(), StepPrice(instrument, sites.places())));
}

namespace {

Result<MeasuringOrder> order_by(const api::Plan& plan, const Instrument& instrument, std::span<const ScanPoint> points,
                                const TimeExperience& experience, std::size_t most_searched) {
  std::vector<std::int32_t> written = as_written(points);
  Contest contest(plan, instrument, points, experience);
  if (plan.order == api::OrderStrategy::Random) shuffle(written, plan.order_seed);
  if (plan.order != api::OrderStrategy::Fastest) {
    contest.enter(std::move(written));
    return std::move(contest).best();
  }
  contest.enter(snaked_order(instrument, points));
  if (written.size() <= most_searched) {
    auto places = places_from_home(instrument, points, written);
    enter_searched(contest, instrument, points, written, std::move(places));
  }
  if (!contest.has_one()) contest.enter(std::move(written));
  return std::move(contest).best();
}

}  // namespace

Result<MeasuringOrder> measuring_order(const api::Plan& plan, const Instrument& instrument,
                                       std::span<const ScanPoint> points, const TimeExperience& experience) {
  return order_by(plan, instrument, points, experience, kMostSearched);
}

Result<MeasuringOrder> quick_order(const api::Plan& plan, const Instrument& instrument,
                                   std::span<const ScanPoint> points, const TimeExperience& experience) {
  return order_by(plan, instrument, points, experience, 0);
}

}  // namespace gonio::daemon
