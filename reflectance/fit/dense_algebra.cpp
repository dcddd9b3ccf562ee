// The adapter of Eigen: its headers are met nowhere else in this room.
#include "reflectance/fit/dense_algebra.h"

#include <cassert>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace gonio::fit {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const RowMajor> mapped(const SquareMatrix& matrix) {
  const auto n = static_cast<Eigen::Index>(matrix.size);
  return {matrix.values.data(), n, n};
}

}  // namespace

struct PositiveSolver::Impl {
  Eigen::LLT<Eigen::MatrixXd> factor;
};

PositiveSolver::PositiveSolver(const SquareMatrix& matrix) : impl_(std::make_unique<Impl>()) {
  impl_->factor.compute(mapped(matrix));
}
PositiveSolver::~PositiveSolver() = default;
PositiveSolver::PositiveSolver(PositiveSolver&&) noexcept = default;
PositiveSolver& PositiveSolver::operator=(PositiveSolver&&) noexcept = default;

void PositiveSolver::solve(std::span<double> b) const {
  assert(static_cast<Eigen::Index>(b.size()) == impl_->factor.rows());
  if (b.empty()) return;
  Eigen::Map<Eigen::VectorXd> x(b.data(), static_cast<Eigen::Index>(b.size()));
  impl_->factor.solveInPlace(x);
}

SymmetricEigen symmetric_eigen(const SquareMatrix& matrix) {
  SymmetricEigen result;
  if (matrix.size == 0) return result;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(mapped(matrix));
  for (Eigen::Index k = 0; k < solver.eigenvalues().size(); ++k) {
    result.values.push_back(solver.eigenvalues()[k]);
    const Eigen::VectorXd v = solver.eigenvectors().col(k);
    result.vectors.emplace_back(v.data(), v.data() + v.size());
  }
  return result;
}

}  // namespace gonio::fit
