#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace gonio::fit {

/// A square matrix, row by row.
struct SquareMatrix {
  explicit SquareMatrix(std::size_t n) : size(n), values(n * n, 0.0) {}
  [[nodiscard]] double& at(std::size_t row, std::size_t column) { return values[row * size + column]; }
  [[nodiscard]] double at(std::size_t row, std::size_t column) const { return values[row * size + column]; }

  std::size_t size;
  std::vector<double> values;
};

/// Solves M x = b for one positive definite M again and again.
class PositiveSolver {
 public:
  /// Reads the lower triangle.
  explicit PositiveSolver(const SquareMatrix& matrix);
  ~PositiveSolver();
  PositiveSolver(PositiveSolver&&) noexcept;
  PositiveSolver& operator=(PositiveSolver&&) noexcept;

  /// In place; as long as the matrix is wide (asserted).
  void solve(std::span<double> b) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Eigenvalues, ascending, and unit eigenvectors: vectors[k] belongs to values[k].
struct SymmetricEigen {
  std::vector<double> values;
  std::vector<std::vector<double>> vectors;
};
/// Reads the lower triangle.
[[nodiscard]] SymmetricEigen symmetric_eigen(const SquareMatrix& matrix);

}  // namespace gonio::fit
