#pragma once

#include <cstdint>
#include <vector>

#include "daemon/config/instrument.h"
#include "daemon/planner/exposure_choice.h"
#include "daemon/planner/visit_place.h"
#include "daemon/sequencer/measurement.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// The level of the used frames of a visit at `point`:
///   sum_j (S_j - D_j) / sum_j (t_j + t0) m_j, of a radiometer sum_j (P_j - D_j) / sum_j m_j,
/// with the darks that the chooser knows. Its u: noise by photon transfer, monitor, and the placing of the carriage and
/// the arms (`u_reproducibility` of the instrument).
[[nodiscard]] VisitLevel level_of(std::int32_t point, const Measurement& visit, const ExposureChooser& chooser,
                                  const Instrument& instrument);

/// The same in units of another level.
[[nodiscard]] VisitLevel in_units_of(const VisitLevel& unit, VisitLevel level);

/// Relative, from one visit to the next.
[[nodiscard]] double drift_between(const VisitLevel& before, const VisitLevel& after);
/// Whether a drift is beyond the limit: and three of its own standard deviations, so that chance measures nothing
/// again.
[[nodiscard]] bool is_beyond(double drift_limit, const VisitLevel& before, const VisitLevel& after);

}  // namespace gonio::daemon
