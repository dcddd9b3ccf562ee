#include "calibration/nearby_secants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "calibration/direction_lines.h"

namespace gonio::calibration {
namespace {

constexpr std::size_t kSecants = 4;
constexpr double kLeastArc = 2e-4;  // 0.01 deg: closer neighbours give noise over nothing

/// The nearest neighbours so far, by arc.
class Nearest {
 public:
  /// What a further one must lie below.
  [[nodiscard]] double reach() const { return found_.back().first; }
  void add(double arc, std::uint32_t point) {
    if (arc < kLeastArc || arc >= reach()) return;
    found_.back() = {arc, point};
    for (std::size_t n = kSecants - 1; n > 0 && found_[n] < found_[n - 1]; --n) std::swap(found_[n], found_[n - 1]);
  }
  [[nodiscard]] const auto& all() const { return found_; }

  static constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

 private:
  static constexpr std::pair<double, std::uint32_t> kNone{kFarthestStop, kNobody};
  std::array<std::pair<double, std::uint32_t>, kSecants> found_{kNone, kNone, kNone, kNone};
};

}  // namespace

NearbySecants::Place NearbySecants::place_of(std::size_t n) const {
  const DirectionKey key = direction_key(points_[n], isotropic_);
  return {.light = key.light,
          .theta_i = key.theta_i,
          .phi_i = isotropic_ ? 0 : key.phi_i,
          .theta_r = points_[n].reported.theta_r.si(),
          .point = static_cast<std::uint32_t>(n)};
}

void NearbySecants::sort() const {
  places_.reserve(points_.size());
  for (std::size_t n = 0; n < points_.size(); ++n) places_.push_back(place_of(n));
  std::ranges::sort(places_, {}, &Place::order);
}

// Between the scattered directions, the source at phi = 0.
double NearbySecants::arc(std::size_t a, std::size_t b) const {
  const Geometry& from = points_[a].reported;
  const Geometry& to = points_[b].reported;
  return phase_angle({.theta_i = from.theta_r,
                      .phi_i = azimuth_between(from, isotropic_),
                      .theta_r = to.theta_r,
                      .phi_r = azimuth_between(to, isotropic_)})
      .si();
}

double NearbySecants::secant(std::size_t n, std::size_t other, double arc) const {
  const SlopeOrdinate& a = ordinates_[n];
  const SlopeOrdinate& b = ordinates_[other];
  const SlopePoint& from = points_[n];
  const SlopePoint& to = points_[other];
  const bool is_log = a.has_logarithm() && b.has_logarithm();
  const double difference = is_log ? a.log_f - b.log_f : (from.value - to.value).si();
  const double noise = is_log ? std::hypot(a.u_log, b.u_log) : std::hypot(from.u_random.si(), to.u_random.si());
  const double clear = std::sqrt(std::max(0.0, difference * difference - noise * noise));
  return (is_log ? from.value.si() : 1.0) * clear / arc;
}

double NearbySecants::steepest(std::size_t n) const {
  std::call_once(sorted_, [this] { sort(); });
  // No arc is shorter than the difference of both theta_r: whoever is further off by it alone ends the walk. A scan of
  // hundreds of thousands of scattered directions ends it by the count.
  constexpr std::size_t kLookedAtMost = 2048;
  const Place own = place_of(n);
  const auto at = std::ranges::lower_bound(places_, own.order(), {}, &Place::order);
  Nearest nearest;
  const auto look_at = [&](const Place& place) {
    if (!place.has_light_of(own) || std::abs(place.theta_r - own.theta_r) >= nearest.reach()) return false;
    nearest.add(arc(n, place.point), place.point);
    return true;
  };
  const auto looked = static_cast<std::ptrdiff_t>(kLookedAtMost);
  for (auto p = at; p != places_.begin() && at - p < looked && look_at(*(p - 1));) --p;
  for (auto p = at + 1; p != places_.end() && p - at < looked && look_at(*p);) ++p;
  double steepest = 0.0;
  for (const auto& [apart, point] : nearest.all()) {
    if (point != Nearest::kNobody) steepest = std::max(steepest, secant(n, point, apart));
  }
  return steepest;
}

}  // namespace gonio::calibration
