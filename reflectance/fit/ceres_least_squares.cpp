// The adapter of Ceres: its headers are met nowhere else in this room. Debian's binary of it brings parts under the GPL
// (THIRD-PARTY.md), so whoever links this library is under its terms as a binary.
#include <algorithm>
#include <utility>

#include <ceres/ceres.h>
#include <fmt/format.h>

#include "reflectance/fit/least_squares.h"

namespace gonio::fit {
namespace {

class WholeCost final : public ceres::CostFunction {
 public:
  explicit WholeCost(const LeastSquares& problem) : problem_(problem) {
    set_num_residuals(static_cast<int>(problem.residuals));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.parameters));
  }

  bool Evaluate(double const* const* x, double* r, double** slopes) const override {
    const bool wants_slopes = slopes != nullptr && slopes[0] != nullptr;
    const std::span<double> all_slopes =
        wants_slopes ? std::span(slopes[0], problem_.residuals * problem_.parameters) : std::span<double>();
    return problem_.evaluate({x[0], problem_.parameters}, {r, problem_.residuals}, all_slopes);
  }

 private:
  const LeastSquares& problem_;
};

ceres::Solver::Options solver_options(int most_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = most_iterations;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  return options;
}

}  // namespace

Result<LeastSquaresMinimum> minimise(const LeastSquares& problem, std::vector<double> start, int most_iterations) {
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  WholeCost cost(problem);
  ceres::Problem bounded(ownership);
  bounded.AddParameterBlock(start.data(), static_cast<int>(problem.parameters));
  for (int k = 0; k < static_cast<int>(problem.parameters); ++k) {
    bounded.SetParameterLowerBound(start.data(), k, 0.0);
    bounded.SetParameterUpperBound(start.data(), k, 1.0);
  }
  bounded.AddResidualBlock(&cost, nullptr, start.data());
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(most_iterations), &bounded, &summary);
  if (summary.termination_type == ceres::FAILURE || summary.termination_type == ceres::USER_FAILURE) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = fmt::format("fit {} numbers to {} values", problem.parameters, problem.residuals),
                    .seen = summary.message,
                    .limit = "a model that is finite at its start"});
  }
  return LeastSquaresMinimum{.x = std::move(start),
                             .sum_of_squares = 2.0 * summary.final_cost,
                             .iterations = static_cast<int>(summary.iterations.size()),
                             .has_converged = summary.termination_type == ceres::CONVERGENCE};
}

}  // namespace gonio::fit
