#include "drivers/motion/axis_profile.h"

#include <algorithm>
#include <cmath>

#include "drivers/motion/travel_time.h"

namespace gonio::drivers {

AxisProfile::AxisProfile(double from, double to, const AxisConfig& how)
    : from_(from),
      to_(to),
      acceleration_(to < from ? -how.acceleration : how.acceleration),
      ramp_s_(std::min(how.speed / how.acceleration, std::sqrt(std::abs(to - from) / how.acceleration))),
      duration_s_(in_seconds(travel_time(to - from, how.speed, how.acceleration))) {}

double AxisProfile::position(double after_s) const {
  if (after_s <= 0.0) return from_;
  if (after_s >= duration_s_) return to_;
  const double left = duration_s_ - after_s;
  if (after_s < ramp_s_) return from_ + 0.5 * acceleration_ * after_s * after_s;
  if (left < ramp_s_) return to_ - 0.5 * acceleration_ * left * left;
  return from_ + acceleration_ * ramp_s_ * (after_s - 0.5 * ramp_s_);
}

}  // namespace gonio::drivers
