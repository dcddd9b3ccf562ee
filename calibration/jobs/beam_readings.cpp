#include "calibration/jobs/beam_readings.h"

#include <fmt/format.h>

#include <cmath>

namespace gonio::calibration {

bool is_straight(const Geometry& planned) {
  constexpr Angle kWithin = degrees(1e-3);
  return degrees(180.0) - phase_angle(planned) < kWithin;
}

Result<BeamReadings> beam_readings_of(const ScanReadings& scan, const InstrumentModel& instrument,
                                      const DarkHistory& darks) {
  std::map<std::int32_t, PlannedPoint> planned;
  for (const PlannedPoint& point : scan.points) planned[point.index] = point;
  const auto thousandths = [](Angle angle) { return std::llround(1e3 * in_degrees(angle)); };
  BeamReadings readings;
  for (const RawReading& reading : scan.readings) {
    if (reading.target != Target::Sample || !reading.point_index) continue;
    const PlannedPoint& point = planned[*reading.point_index];
    Result<NormalisedReading> q = normalise(reading, darks, instrument.detector);
    if (!q) return failure(std::move(q).error());
    const double u = std::hypot(q->u_noise, q->u_monitor, instrument.lamp.u_reproducibility * q->q);
    readings[std::llround(in_nanometres(point.wavelength) * 1e3)].push_back(
        {.read = std::move(*q),
         .u = u,
         .planned = point.geometry,
         .place = {thousandths(point.geometry.theta_r), thousandths(point.geometry.phi_r)}});
  }
  return readings;
}

double u_of_darks(std::span<const BeamReading> readings, std::span<const double> weights, double u_drift_dn_per_s) {
  struct Effect {
    double of_level = 0.0;
    double u_dn = 0.0;
  };
  std::map<std::pair<ExposureRung, std::int64_t>, Effect> by_visit;
  double drift = 0.0;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    for (const DarkShare& share : readings[k].read.darks) {
      const DarkLevel& level = share.level;
      const auto add = [&](const DarkVisit* visit, double part) {
        if (visit == nullptr) return;
        Effect& effect = by_visit[{share.rung, visit->visit_id}];
        effect.of_level += weights[k] * share.dq_dlevel * part;
        effect.u_dn = visit->u_dn;
      };
      add(level.before, 1.0 - level.weight_after);
      add(level.after, level.weight_after);
      const double exposure_s = 1e-6 * static_cast<double>(share.rung.exposure_us);
      drift += weights[k] * share.dq_dlevel * level.drift_widening * u_drift_dn_per_s * exposure_s;
    }
  }
  double variance = drift * drift;
  for (const auto& [visit, effect] : by_visit) variance += std::pow(effect.of_level * effect.u_dn, 2);
  return std::sqrt(variance);
}

std::string nm_text(Wavelength wavelength) {
  return fmt::format("{:.7g}nm", in_nanometres(wavelength));
}

}  // namespace gonio::calibration
