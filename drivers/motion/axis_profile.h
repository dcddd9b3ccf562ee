#pragma once

#include "drivers/stage_config.h"

namespace gonio::drivers {

/// One axis' motion from rest to rest with trapezoidal speed (triangular when the way is short): the position at any
/// time after the start, in the axis' unit. Monotone. Before its start it stands at `from`, after its end at `to`.
class AxisProfile {
 public:
  AxisProfile() = default;
  AxisProfile(double from, double to, const AxisConfig& how);

  [[nodiscard]] double position(double after_s) const;
  [[nodiscard]] double duration_s() const { return duration_s_; }

 private:
  double from_ = 0.0;
  double to_ = 0.0;
  double acceleration_ = 0.0;  ///< signed, along the way
  double ramp_s_ = 0.0;
  double duration_s_ = 0.0;
};

}  // namespace gonio::drivers
