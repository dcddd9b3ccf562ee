#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibration/calibrated_scan.h"
#include "sim/scene/truth.h"

namespace gonio::coverage {

/// The groups of points in which the claim must hold by itself. Chosen by the truth, never by what was measured.
enum class Stratum : std::uint8_t {
  Near,      ///< theta_r below 30 deg
  Middle,    ///< 30 to 60 deg
  Far,       ///< from 60 deg
  Lobe,      ///< above half of the scan's largest value, in a scene with a lobe
  NearZero,  ///< |truth| <= U
};
inline constexpr std::size_t kStrata = 5;
[[nodiscard]] const char* stratum_name(Stratum stratum);

/// One value beside the truth.
struct ValueOutcome {
  std::int32_t point = 0;
  double error = 0.0;     ///< value - truth, sr^-1
  double u = 0.0;         ///< combined, k = 1
  double expanded = 0.0;  ///< U
  double below = 0.0;     ///< the interval is [value - below, value + above]
  double above = 0.0;
  double value = 0.0;
  std::uint8_t strata = 0;  ///< bits by Stratum
  [[nodiscard]] bool is_held() const;
};

/// What one repetition found.
struct RepetitionOutcome {
  std::vector<ValueOutcome> points;
  std::vector<ValueOutcome> rho;  ///< one each theta_i: the sum over the measured rings, correlations kept
  std::vector<ErrorCode> refused;
  std::size_t planned = 0;
};

/// Each value of a calibrated scan beside the simulator's truth at the directions reported.
/// `correlation`: false takes all terms for random in rho_dh.
[[nodiscard]] RepetitionOutcome outcome_of(const calibration::CalibratedScan& scan, const sim::Truth& truth,
                                           std::size_t planned, bool has_lobe, bool correlation = true);

/// A mean over repetitions and its standard error: points of one repetition share errors and are one trial.
struct Share {
  double value = 0.0;
  double standard_error = 0.0;
};

struct StratumFigures {
  double values_per_repetition = 0.0;
  double held = 0.0;
  double rms_z = 0.0;  ///< of (value - truth) / u
};

struct CoverageFigures {
  int repetitions = 0;
  Share held;      ///< of the points' intervals
  Share rho_held;  ///< of those of rho_dh
  double rms_z = 0.0;
  double rho_rms_z = 0.0;
  double width = 0.0;              ///< mean(U/2) / RMS(value - truth), mean over the points
  double rho_width = 0.0;          ///< the same for rho_dh
  double least_point = 0.0;        ///< share held of the worst point
  double relative_expanded = 0.0;  ///< median of U/|f| over points, of their means
  double refused = 0.0;            ///< share of the planned points
  std::map<ErrorCode, std::size_t> refused_for;
  std::vector<StratumFigures> strata;  ///< [kStrata]
};
[[nodiscard]] CoverageFigures figures_of(const std::vector<RepetitionOutcome>& repetitions);

/// What is demanded of the figures.
struct Claim {
  double held_margin = 0.015;  ///< about 0.9545
  double rho_margin = 0.015;
  double rms_low = 0.85;
  double rms_high = 1.15;
  double width_at_most = 1.3;
  double refused_at_most = 0.02;
  /// The same with three standard errors of a count of so few repetitions on top.
  [[nodiscard]] static Claim for_few(int repetitions);
};

/// Every part of the claim that the figures do not meet, in words with numbers; empty when it holds. A stratum with
/// less than one value in two repetitions has too few to be judged.
[[nodiscard]] std::vector<std::string> failures(const CoverageFigures& figures, const Claim& claim);

}  // namespace gonio::coverage
