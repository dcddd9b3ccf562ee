#pragma once

#include <array>
#include <cstdint>

#include "calibration/budget.h"
#include "calibration/direction_slopes.h"
#include "calibration/term_list.h"

namespace gonio::calibration {

/// Where the law of propagation does not hold, or might not.
struct Nonlinearity {
  std::array<double, kDirectionAxes> slope{};      ///< d f/d angle of the zeros' terms, sr^-1 per rad
  std::array<double, kDirectionAxes> curvature{};  ///< second derivatives, sr^-1 per rad^2
  std::array<double, kDirectionAxes> u_angle{};    ///< rad
};

/// The relative standard uncertainty of the divisor q_ref, of all terms that are marked as its errors.
[[nodiscard]] double relative_divisor(const TermList& terms);

/// Whether the formula is to be left: the divisor's relative u passes 5 %, or the second-order terms of the angles
/// (JCGM 100:2008, 5.1.2 note: half the second derivative times u^2) pass 10 % of u. A dominant rectangular component
/// alone does not ask for it: its k has a closed form (coverage_interval.h).
[[nodiscard]] bool needs_monte_carlo(const Budget& budget, const TermList& terms, const Nonlinearity& bent);

/// The distribution of the value by Monte Carlo (JCGM 101:2008, 7), with the full equation of the ratio:
///   f = (f_0 + X + sum_a c_a d_a^2 / 2 + sum_k a_k r_k) / (1 + D),
/// D and X normal with the variances and the covariance of their terms (a sum of independent normal errors is normal,
/// so that one draw stands for all of them), d_a the angles' errors, r_k the rectangular ones. kTrials draws; the same
/// `stream` gives the same bits. Fills u, k, U, below, above and method of `budget`; Student's k over the normal one
/// widens the interval where the formula's degrees of freedom ask for it. `terms` as the budget was made from.
inline constexpr int kMonteCarloTrials = 20000;
void propagate_by_monte_carlo(double value, const TermList& terms, const Nonlinearity& bent, std::uint64_t stream,
                              Budget& budget);

}  // namespace gonio::calibration
