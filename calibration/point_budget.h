#pragma once

#include <string>
#include <vector>

#include "calibration/cone_correction.h"
#include "calibration/direction_slopes.h"
#include "calibration/monte_carlo.h"
#include "calibration/point_equation.h"
#include "calibration/spectral_term.h"
#include "calibration/term_list.h"

namespace gonio::calibration {

/// u(f_s) of the readings' own noise, placing included: what scatters from point to point. sr^-1.
[[nodiscard]] Brdf scatter(const PairedPoint& point, const InstrumentModel& instrument);

/// What the budgets of a scan have in common, worked out once. What it refers to must outlive it. Threads: any.
class BudgetRules {
 public:
  BudgetRules(const InstrumentModel& instrument, const ReferenceStandard& standard, bool has_trap_visits);

  /// All terms of u(f_s) as listed in calibrate.h, into an empty list: `terms.budget()` is the point's budget.
  void add_terms(const PairedPoint& point, const DirectionSlopes& slopes, const ConeCorrection& cones,
                 const SpectralSlope& spectral, TermList& terms) const;
  /// What in the point's equation is not linear in its angles.
  [[nodiscard]] Nonlinearity nonlinearity(const PairedPoint& point, const DirectionSlopes& slopes) const;

 private:
  friend class PointTerms;

  const InstrumentModel& instrument_;
  const ReferenceStandard& standard_;
  bool has_trap_visits_;
  std::vector<double> zero_factor_;       ///< covariance_factor of the zeros; empty: independent
  std::vector<double> linearity_factor_;  ///< of the coefficients and t0; empty: none
  std::array<double, kDirectionAxes> u_zero_{};
  std::array<double, kDirectionAxes> u_angle_{};  ///< zero and repeatability
  std::string instrument_owner_;
  std::string standard_owner_;
};

}  // namespace gonio::calibration
