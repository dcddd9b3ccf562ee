#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/clock.h"
#include "base/result.h"
#include "calibration/calibrated_scan.h"
#include "calibration/instrument_model.h"
#include "calibration/left_out.h"
#include "calibration/raw_reading.h"
#include "calibration/reference_standard.h"

namespace gonio::calibration {

/// The rules of this room, as one number: grows whenever the same inputs would give other values.
inline constexpr std::string_view kCalibrationCode = "gonio-calibration-4";

/// When budgets are made by Monte Carlo.
enum class MonteCarloUse : std::uint8_t {
  WhereNeeded,  ///< where the formula does not hold (monte_carlo.h)
  Never,
  Always,
};

/// How a calibration is made.
struct CalibrationOptions {
  bool correct_drift = true;  ///< false: visits of the standard count for nothing
  MonteCarloUse monte_carlo = MonteCarloUse::WhereNeeded;
  std::uint64_t seed = 1;  ///< of Monte Carlo: each point has its own stream
  int threads = 0;         ///< at most; 0: as many as the machine has. The result has the same bits
  LeftOut left_out;
};

/// Readings to BRDF by the ratio to the reference at the same geometry and wavelength:
///   f_s(G) = f_ref(G_ref) q_s mu_i,ref / (q_ref mu_i,s),
/// where source power, solid angles and overlap cancel and the cosines (of the radiance mode: field of view inside the
/// lit spot) differ only by what the encoders say. q as in NormalisedReading, f_ref as in ReferenceStandard, pairs as
/// in reading_pairs.h; directions in the frame of each surface (zeros, mounting_term.h), stray light as in
/// point_equation.h, the cones of source and detector taken out by the bend of the neighbouring points
/// (cone_correction.h).
///
/// u(f) by the law of propagation (JCGM 100:2008, eq 13), every term in sr^-1. Components, each only where its u is not
/// 0:
/// - random: noise, monitor, angle repeatability and reproducibility of sample and reference readings, noise of the
///   cones' correction, the course of a drift that no sine of drift_bridge.h holds. A reference reading that serves
///   several points becomes one shared component of theirs instead;
/// - shared: certificate; shape modes, the shape's integral and its interpolation; zeros of the arms through
///   d f_s/d angle - f_s d ln f_ref/d angle (direction_slopes.h), and what those slopes leave unresolved; exposure
///   offset; linearity L(N_s) - L(N_ref), L = eps N / full scale, and the parts of its fit; lamp after the monitor, one
///   component for each correlation time, with u^2 = u_after^2 (1 - exp(-dt^2 / (2 correlation^2))); each dark, ambient
///   and trap visit; drift between darks, one for each interval; gains and ranges; each reference visit, and what the
///   line between two of them misses; stray light; size of the cones and unresolved curvature; polarisation; lean and
///   height of both mountings; wavelength and bandwidth.
/// Drift: with two or more visits of the standard (drift_history.h) f_s is multiplied by g(t_ref) / g(t_s), g the
/// response to the standard at the visits' geometry, linear between them.
/// Monte Carlo stands in where the formula does not hold (monte_carlo.h), and the point says so.
/// Points whose reading cannot be used are listed with the reason; they are never filled in.
/// Errors: ReferenceExpired at `measured_on`. Pure: the same inputs give the same bits, for any number of threads.
[[nodiscard]] Result<CalibratedScan> calibrate(const ScanReadings& scan, const InstrumentModel& instrument,
                                               const ReferenceStandard& standard, UtcTime measured_on,
                                               const CalibrationOptions& options = {});

/// All that `calibrate` rests on beside the readings, as one text with all digits: its hash names a calibration.
[[nodiscard]] std::string describe_inputs(const InstrumentModel& instrument, const ReferenceStandard& standard,
                                          const CalibrationOptions& options = {});

}  // namespace gonio::calibration
