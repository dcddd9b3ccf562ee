#pragma once

#include <deque>
#include <optional>

#include "base/clock.h"
#include "daemon/config/holds.h"

namespace gonio::daemon {

/// How far a lamp is on its way to being warm.
struct WarmUpProgress {
  std::optional<double> slope_per_s;  ///< relative, magnitude; nothing: not looked at long enough
  double limit_per_s = 0.0;
  Duration waited{};    ///< since a scan waits for it; zero: none does
  Duration at_least{};  ///< still to be looked at, before anything can be said
  Duration at_most{};   ///< until the scan holds
};

/// The lamp's warm-up criterion: a straight line through the monitor's values of the last `over` (least squares) is so
/// flat that its slope plus twice its standard uncertainty, over the mean, lies below the limit. Two values are at most
/// a quarter of `over` apart, else the count begins anew. Pure.
class LampWatch {
 public:
  explicit LampWatch(std::optional<LampWarmUp> wanted) : wanted_(wanted) {}

  void see(double monitor, Instant now);
  /// Nothing counts any more: the lamp was out.
  void forget() { seen_.clear(); }

  /// True as well where nothing is wanted.
  [[nodiscard]] bool is_warm(Instant now) const;
  [[nodiscard]] std::optional<double> slope_per_s(Instant now) const;
  /// How long it has still to be looked at before it can be judged.
  [[nodiscard]] Duration still_to_see(Instant now) const;
  /// How often a value is wanted while a scan waits.
  [[nodiscard]] Duration sampling() const;
  [[nodiscard]] const std::optional<LampWarmUp>& wanted() const { return wanted_; }

 private:
  struct Value {
    Instant at{};
    double monitor = 0.0;
  };
  struct Slope {
    double per_s = 0.0;
    double u_per_s = 0.0;
  };
  [[nodiscard]] std::optional<Slope> slope(Instant now) const;

  std::optional<LampWarmUp> wanted_;
  std::deque<Value> seen_;  ///< ascending, at most a few hundred
};

}  // namespace gonio::daemon
