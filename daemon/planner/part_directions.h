#pragma once

#include <functional>
#include <optional>

#include "base/geometry.h"
#include "base/result.h"
#include "daemon/config/instrument.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {

/// A direction that a part of a plan asks for, in the axes' sense: phi_r as the sample sees it.
struct AskedDirection {
  Geometry geometry;
  std::optional<Wavelength> wavelength;  ///< none: each of the part's
  int line = 0;                          ///< of the list of points; 0: not from one
  bool may_be_out_of_reach = false;      ///< then it is left out; else the plan is refused
  /// Of rings: directions of one level are kept or left out together, the lowest first, so that what is kept are even
  /// azimuths on every ring. -1: a direction that stands for itself.
  int level = -1;
};

using TakeDirection = std::function<Result<void>(const AskedDirection&)>;

/// The directions of a part, always in the same order, theta_i slowest, then phi_i. `is_relative`: phi_r counts from
/// phi_i. Ends with the first error of `take`. Errors: InvalidInput (rings without to_deg on a stage whose reach is no
/// angle of its own; no arm's reach).
[[nodiscard]] Result<void> for_each_direction(const api::PlanPart& part, const Instrument& instrument, bool is_relative,
                                              const TakeDirection& take);

}  // namespace gonio::daemon
