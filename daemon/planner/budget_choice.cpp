#include "daemon/planner/budget_choice.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "daemon/planner/measuring_order.h"

namespace gonio::daemon {

namespace {

// Where a direction lies for the choice: both of its unit vectors; another wavelength lies apart.
using Spot = std::array<double, 7>;

std::array<double, 3> unit_vector(Angle theta, Angle phi) {
  const double sine = std::sin(theta.si());
  return {sine * std::cos(phi.si()), sine * std::sin(phi.si()), std::cos(theta.si())};
}

Spot spot_of(const ScanPoint& point) {
  constexpr double kPerMetre = 1e8;  // 10 nm are as far as opposite directions are
  const auto r = unit_vector(point.geometry.theta_r, point.geometry.phi_r);
  const auto i = unit_vector(point.geometry.theta_i, point.geometry.phi_i);
  return {r[0], r[1], r[2], i[0], i[1], i[2], kPerMetre * point.wavelength.si()};
}

double distance2(const Spot& a, const Spot& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

// What is kept or left out together.
struct Unit {
  std::vector<std::size_t> members;  ///< candidates
  double turn = 0.0;                 ///< when it is taken
};

// The units of one part, the most wanted first.
class Thinning {
 public:
  Thinning(std::span<const BudgetCandidate> candidates, std::vector<Unit> units) : units_(std::move(units)) {
    for (const Unit& unit : units_) spots_.push_back(spot_of(candidates[unit.members.front()].point));
    for (std::size_t k = 0; k < spots_.size(); ++k) spacing_.push_back(spacing(k));
  }

  // Farthest first (Gonzalez 1985); of equals the first in the plan's text.
  std::vector<Unit> in_order() && {
    std::vector<double> nearest2(units_.size(), std::numeric_limits<double>::infinity());
    std::vector<Unit> order;
    std::size_t next = 0;
    for (std::size_t taken = 0; taken < units_.size(); ++taken) {
      order.push_back(std::move(units_[next]));
      const std::size_t last = next;
      nearest2[last] = -1.0;
      for (std::size_t k = 0; k < units_.size(); ++k) {
        if (nearest2[k] >= 0.0) nearest2[k] = std::min(nearest2[k], distance2(spots_[k], spots_[last]) / spacing_[k]);
        if (nearest2[k] > nearest2[next]) next = k;
      }
    }
    return order;
  }

 private:
  // To the nearest other one. By its root distances are weighed: halfway between thinning what the author asked for
  // everywhere alike, which keeps a product's crowd at the pole, and filling the sphere evenly, which strips a cone's
  // peak.
  [[nodiscard]] double spacing(std::size_t k) const {
    constexpr double kLeast2 = 1e-12;
    double least2 = std::numeric_limits<double>::infinity();
    for (std::size_t other = 0; other < spots_.size(); ++other) {
      if (other != k) least2 = std::min(least2, distance2(spots_[k], spots_[other]));
    }
    return std::isinf(least2) ? 1.0 : std::sqrt(std::max(least2, kLeast2));
  }

  std::vector<Unit> units_;
  std::vector<Spot> spots_;
  std::vector<double> spacing_;
};

// A searched order is quicker than the quick one by a share that hardly depends on the number of points.
constexpr int kSharingRounds = 3;

// Beyond so many units of a part a choice by distances takes too long; they are taken evenly along the plan's text.
constexpr std::size_t kMostThinned = 8'000;

std::vector<Unit> evenly_along(std::vector<Unit> units) {
  constexpr double kGolden = 0.6180339887498949;  // successive multiples lie as far apart as can be
  std::vector<std::pair<double, std::size_t>> places;
  for (std::size_t k = 0; k < units.size(); ++k) {
    const double place = static_cast<double>(k) * kGolden;
    places.emplace_back(place - std::floor(place), k);
  }
  std::ranges::sort(places);
  std::vector<Unit> order(units.size());
  for (std::size_t k = 0; k < units.size(); ++k) order[places[k].second] = std::move(units[k]);
  return order;
}

std::vector<Unit> in_order_of_want(std::span<const BudgetCandidate> candidates, std::vector<Unit> units) {
  const auto level_of = [&](const Unit& unit) { return candidates[unit.members.front()].level; };
  if (level_of(units.front()) >= 0) {
    std::ranges::stable_sort(units, {}, level_of);
    return units;
  }
  if (units.size() > kMostThinned) return evenly_along(std::move(units));
  return Thinning(candidates, std::move(units)).in_order();
}

// All units, the most wanted first. Each part's first comes before any part's second.
std::vector<Unit> by_want(std::span<const BudgetCandidate> candidates) {
  std::map<int, std::map<int, Unit>> parts;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (!candidates[k].point.blocked) parts[candidates[k].part][candidates[k].unit].members.push_back(k);
  }
  std::vector<Unit> all;
  for (auto& [part, named] : parts) {
    std::vector<Unit> units;
    for (auto& [name, unit] : named) units.push_back(std::move(unit));
    units = in_order_of_want(candidates, std::move(units));
    std::size_t size = 0;
    for (const Unit& unit : units) size += unit.members.size();
    std::size_t taken = 0;
    for (Unit& unit : units) {
      unit.turn = static_cast<double>(taken) / static_cast<double>(size);
      taken += unit.members.size();
      all.push_back(std::move(unit));
    }
  }
  std::ranges::stable_sort(all, {}, &Unit::turn);
  return all;
}

class Sharing {
 public:
  Sharing(const api::Plan& plan, const Instrument& instrument, const TimeExperience& experience,
          std::span<const BudgetCandidate> candidates)
      : plan_(plan),
        instrument_(instrument),
        experience_(experience),
        candidates_(candidates),
        units_(by_want(candidates)),
        allowed_(plan.budget->time) {
    for (const Unit& unit : units_) least_ += unit.turn == 0.0 ? 1 : 0;
    for (const BudgetCandidate& candidate : candidates_) most_repeats_ = std::max(most_repeats_, candidate.repeats);
  }

  Result<BudgetShare> run() {
    const auto wished = searched_time_of(all());
    if (!wished) return failure(wished.error());
    wished_ = *wished;
    if (wished_ <= allowed_) return share(all());
    if (plan_.budget->least_snr) {
      const double asked_snr = plan_.target_snr;
      plan_.target_snr = *plan_.budget->least_snr;
      const auto noisy = searched_time_of(all());
      if (!noisy) return failure(noisy.error());
      if (*noisy <= allowed_) return share_noise(asked_snr);
      if (*noisy >= wished_) plan_.target_snr = asked_snr;  // light that nobody can foresee: nothing is won by noise
    }
    return share_points();
  }

 private:
  [[nodiscard]] std::size_t all() const { return units_.size() * static_cast<std::size_t>(most_repeats_); }

  // The first `count` of the units once each, then again for the second time, and so on.
  [[nodiscard]] std::vector<int> repeats_of(std::size_t count) const {
    std::vector<int> repeats(candidates_.size(), 0);
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (candidates_[k].point.blocked) repeats[k] = candidates_[k].repeats;
    }
    for (std::size_t n = 0; n < count; ++n) {
      for (const std::size_t k : units_[n % units_.size()].members) {
        repeats[k] = std::min(repeats[k] + 1, candidates_[k].repeats);
      }
    }
    return repeats;
  }

  [[nodiscard]] std::vector<ScanPoint> points_of(std::size_t count) const {
    const std::vector<int> repeats = repeats_of(count);
    std::vector<ScanPoint> points;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      for (int n = 0; n < repeats[k]; ++n) {
        points.push_back(candidates_[k].point);
        points.back().index = static_cast<std::int32_t>(points.size()) - 1;
      }
    }
    return points;
  }
  [[nodiscard]] Result<Duration> time_of(std::size_t count) const {
    auto order = quick_order(plan_, instrument_, points_of(count), experience_);
    if (!order) return failure(order.error());
    return order->time.total();
  }
  // As the scan will be planned.
  [[nodiscard]] Result<Duration> searched_time_of(std::size_t count) const {
    auto order = measuring_order(plan_, instrument_, points_of(count), experience_);
    if (!order) return failure(order.error());
    return order->time.total();
  }

  // The highest signal-to-noise at which everything fits.
  Result<BudgetShare> share_noise(double asked_snr) {
    constexpr int kSteps = 6;
    double low = *plan_.budget->least_snr;
    double high = asked_snr;
    for (int step = 0; step < kSteps; ++step) {
      plan_.target_snr = std::sqrt(low * high);
      const auto time = searched_time_of(all());
      if (!time) return failure(time.error());
      (*time <= allowed_ ? low : high) = plan_.target_snr;
    }
    plan_.target_snr = low;
    return share(all());
  }

  Result<BudgetShare> share_points() {
    const auto least = searched_time_of(least_);
    if (!least) return failure(least.error());
    if (*least > allowed_) return failure(too_little(*least));
    std::size_t best = least_;
    double quick_over_searched = 1.0;
    for (int round = 0; round < kSharingRounds; ++round) {
      const auto fits = most_within(seconds(in_seconds(allowed_) * quick_over_searched));
      if (!fits) return failure(fits.error());
      const auto quick = time_of(*fits);
      const auto searched = searched_time_of(*fits);
      if (!quick || !searched) return failure(quick ? searched.error() : quick.error());
      if (*searched <= allowed_) best = std::max(best, *fits);
      if (plan_.order != api::OrderStrategy::Fastest) break;
      constexpr double kCaution = 0.99;
      quick_over_searched = kCaution * in_seconds(*quick) / in_seconds(*searched);
    }
    return share(best);
  }

  // By the quick order's time, from the least on.
  [[nodiscard]] Result<std::size_t> most_within(Duration allowed) const {
    std::size_t fits = least_;
    std::size_t too_many = all() + 1;
    while (too_many - fits > 1) {
      const std::size_t middle = fits + (too_many - fits) / 2;
      const auto time = time_of(middle);
      if (!time) return failure(time.error());
      (*time <= allowed ? fits : too_many) = middle;
    }
    return fits;
  }

  [[nodiscard]] Error too_little(Duration least) const {
    constexpr double kMinute = 60.0;
    return Error{.code = ErrorCode::InvalidInput,
                 .device = "plan",
                 .tried = "share out [budget] time_min",
                 .seen = fmt::format("{:.1f} min for {} directions, the least there is of each part",
                                     in_seconds(least) / kMinute, least_),
                 .limit = fmt::format("{:.1f} min", in_seconds(allowed_) / kMinute),
                 .where = InputLocation{.field = "budget.time_min"}};
  }

  [[nodiscard]] BudgetShare share(std::size_t count) const {
    BudgetShare share{.repeats = repeats_of(count),
                      .choice = {.allowed = allowed_, .wished = wished_, .target_snr = plan_.target_snr}};
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (candidates_[k].point.blocked) continue;
      ++share.choice.directions;
      share.choice.kept += share.repeats[k] > 0 ? 1 : 0;
      share.choice.repeats += candidates_[k].repeats - 1;
      share.choice.kept_repeats += std::max(share.repeats[k] - 1, 0);
    }
    share.choice.widest_gap = widest_gap(share.repeats);
    return share;
  }

  // From a detector's direction that is left out to the nearest one kept, under the same light. Of very many that are
  // left out not each is looked at.
  [[nodiscard]] Angle widest_gap(const std::vector<int>& repeats) const {
    constexpr std::size_t kMostLooks = 20'000'000;
    using Light = std::array<double, 3>;
    const auto light_of = [](const ScanPoint& p) {
      return Light{p.geometry.theta_i.si(), p.geometry.phi_i.si(), p.wavelength.si()};
    };
    std::map<Light, std::vector<std::array<double, 3>>> kept;
    std::vector<std::size_t> left_out;
    for (std::size_t k = 0; k < repeats.size(); ++k) {
      const ScanPoint& point = candidates_[k].point;
      if (repeats[k] == 0) left_out.push_back(k);
      if (repeats[k] > 0 && !point.blocked)
        kept[light_of(point)].push_back(unit_vector(point.geometry.theta_r, point.geometry.phi_r));
    }
    const std::size_t looks = left_out.size() * (repeats.size() - left_out.size());
    double least_cosine = 1.0;
    for (std::size_t n = 0; n < left_out.size(); n += 1 + looks / kMostLooks) {
      const ScanPoint& point = candidates_[left_out[n]].point;
      const auto r = unit_vector(point.geometry.theta_r, point.geometry.phi_r);
      double nearest = -1.0;
      for (const auto& d : kept[light_of(point)]) nearest = std::max(nearest, r[0] * d[0] + r[1] * d[1] + r[2] * d[2]);
      least_cosine = std::min(least_cosine, nearest);
    }
    return radians(std::acos(std::clamp(least_cosine, -1.0, 1.0)));
  }

  api::Plan plan_;  ///< its target_snr is tried out
  const Instrument& instrument_;
  const TimeExperience& experience_;
  std::span<const BudgetCandidate> candidates_;
  std::vector<Unit> units_;
  Duration allowed_;
  Duration wished_{};
  std::size_t least_ = 0;
  int most_repeats_ = 1;
};

}  // namespace

Result<BudgetShare> share_out(const api::Plan& plan, const Instrument& instrument, const TimeExperience& experience,
                              std::span<const BudgetCandidate> candidates) {
  return Sharing(plan, instrument, experience, candidates).run();
}

}  // namespace gonio::daemon
