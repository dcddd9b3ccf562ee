#include "daemon/sequencer/visit_level.h"

#include <algorithm>
#include <cmath>

namespace gonio::daemon {

VisitLevel level_of(std::int32_t point, const Measurement& visit, const ExposureChooser& chooser,
                    const Instrument& instrument) {
  const bool is_camera = !instrument.detector.power;
  const double offset_s = is_camera ? instrument.model.detector.exposure_offset_s.value : 0.0;
  double net = 0.0;
  double light = 0.0;
  double variance = 0.0;
  double u_light2 = 0.0;
  for (std::size_t k = 0; k < visit.readings().size(); ++k) {
    const ReadingRecord& reading = visit.readings()[k];
    if (!reading.used) continue;
    const std::size_t rung = visit.rung_of(k);
    const double weight = chooser.weight(rung) + offset_s;
    const double net_here = reading.region.mean - chooser.dark_dn(rung);
    // A camera's weight grows with the exposure; a radiometer's with the smallness of its range, and what it says in
    // parts of the range is the more light the smaller that is.
    const double unit = is_camera ? 1.0 : 1.0 / weight;
    net += net_here * unit;
    light += (is_camera ? weight : 1.0) * reading.monitor_mean;
    variance += chooser.frame_variance(net_here, reading.region.n) * unit * unit;
    const double u_monitor =
        std::hypot(reading.monitor_se, instrument.model.detector.u_monitor_window * reading.monitor_mean);
    u_light2 += std::pow((is_camera ? weight : 1.0) * u_monitor, 2);
  }
  if (!(light > 0.0) || !(net > 0.0)) return {.point = point, .level = 0.0, .u_relative = 1.0, .drift = std::nullopt};
  const double placing = instrument.model.lamp.u_reproducibility;
  return {.point = point,
          .level = net / light,
          .u_relative = std::sqrt(variance / (net * net) + u_light2 / (light * light) + placing * placing),
          .drift = std::nullopt};
}

VisitLevel in_units_of(const VisitLevel& unit, VisitLevel level) {
  if (!(unit.level > 0.0)) return level;
  level.level /= unit.level;
  level.u_relative = std::hypot(level.u_relative, unit.u_relative);
  return level;
}

double drift_between(const VisitLevel& before, const VisitLevel& after) {
  return before.level > 0.0 ? after.level / before.level - 1.0 : 0.0;
}

bool is_beyond(double drift_limit, const VisitLevel& before, const VisitLevel& after) {
  constexpr double kCertain = 3.0;
  const double u = std::hypot(before.u_relative, after.u_relative);
  return std::abs(drift_between(before, after)) > std::max(drift_limit, kCertain * u);
}

}  // namespace gonio::daemon
