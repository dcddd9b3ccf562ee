#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/units.h"
#include "calibration/budget_terms.h"

namespace gonio::calibration {

/// Random: drawn anew for each point. Shared: one error, which all points feel with their own sensitivities (JCGM
/// 100:2008, 5.2: the correlation that a sum over points must keep).
enum class ComponentKind : std::uint8_t { Random, Shared };

/// What is known of how an error is distributed. Rectangular: a stated bound, u = half width / sqrt(3). Arcsine: it
/// goes with the cosine of an angle of which nothing is known, u = amplitude / sqrt(2) (JCGM 101:2008, 6.4.6).
enum class Distribution : std::uint8_t { Normal, Rectangular, Arcsine };

/// How a budget was made. FormulaWithBounds: errors that have bounds are so large that k is not Student's
/// (coverage_interval.h).
enum class BudgetMethod : std::uint8_t { Formula, FormulaWithBounds, MonteCarlo };

/// Most angles of which nothing is known in one scan.
inline constexpr std::size_t kUnknownAngles = 4;

/// One source of uncertainty of a scan.
struct Component {
  std::string name;  ///< "certificate", "zero theta_i", "dark visit 12 at 0.064 s"
  ComponentKind kind = ComponentKind::Shared;
  double u = 0.0;    ///< k = 1, in `unit`; 0 when it differs from point to point
  std::string unit;  ///< "1" when relative
  double degrees_of_freedom = std::numeric_limits<double>::infinity();  ///< of u
  Distribution distribution = Distribution::Normal;
  /// Of an arcsine component, 0 to kUnknownAngles - 1: the angle that it goes with. Two components of one angle are its
  /// cosine and its sine: together they are one arcsine error again, of the root of both squares.
  std::uint8_t unknown_angle = 0;
  /// What the error belongs to: components of two scans with the same name and owner are one error. Empty: this scan
  /// alone has it.
  std::string owner;
  /// Of a shared component: true where one error acts on all points with the signs of their terms, so that it cancels
  /// between them; false where the terms are sizes alone and nobody knows the error's course over the points.
  bool is_pattern_known = true;
  /// Its u is that of the scan's one estimate of wander, as of all components so marked: for the degrees of freedom
  /// their squares count as one.
  bool is_of_the_wander = false;
};

/// The uncertainty of one value. Terms of the same component never come twice. Both lists live as long as the columns
/// that the budget was made in: of a scan's point, as long as the scan or a copy of it.
struct Budget {
  BudgetTerms random;
  BudgetTerms shared;
  Brdf u_random;  ///< root sum of squares of `random`
  Brdf u_shared;  ///< root sum of squares of `shared`: components are independent of each other
  Brdf u;         ///< combined standard uncertainty u_c
  double degrees_of_freedom = std::numeric_limits<double>::infinity();  ///< effective, Welch-Satterthwaite
  double k = 0.0;                                                       ///< for a level of confidence of 95.45 %
  Brdf expanded;                                                        ///< U = k u_c
  BudgetMethod method = BudgetMethod::Formula;
  /// The 95.45 % interval is [value - below, value + above]. By formula both are U; by Monte Carlo it is the interval
  /// with as much beyond either end, U the larger of both, u the standard deviation, k = U / u.
  Brdf below;
  Brdf above;
};

/// Sorts the terms, merges those of one component (random: root sum of squares; shared: signed sum), leaves out those
/// that are 0, and adds all up: u_c, the effective degrees of freedom (JCGM 100:2008, eq G.2b, over estimates that are
/// independent), k and U. Both lists are left sorted; what is made of them goes to `made`, the budget's own.
[[nodiscard]] Budget make_budget(std::span<const Component> components, std::vector<BudgetTerm>& random,
                                 std::vector<BudgetTerm>& shared, TermColumns& made);

/// k for a level of confidence of 95.45 %: Student's t at p = 0.9545 for `degrees_of_freedom` > 0 (JCGM 100:2008, table
/// G.2; it need not be whole), 2.000 for infinity.
[[nodiscard]] double coverage_factor(double degrees_of_freedom);

/// One value of a weighted sum over a scan's points, and the uncertainty that keeps the correlations:
///   u^2(sum w_j f_j) = sum (w_j u_random,j)^2 + sum_k (sum_j w_j c_kj)^2.
struct SumTerm {
  double weight = 0.0;
  Brdf value;
  const Budget* budget = nullptr;  ///< of a point of the same scan
};
/// In sr^-1 times the unit of the weights.
struct WeightedSum {
  Brdf value;
  Brdf u;  ///< k = 1
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  double k = 0.0;  ///< for 95.45 %, by the same rules as a point's
  Brdf expanded;   ///< U = k u
};
/// `components`: those of the scan. The terms are added in their order: the same bits every time.
[[nodiscard]] WeightedSum weighted_sum(std::span<const Component> components, std::span<const SumTerm> terms);

}  // namespace gonio::calibration
