#pragma once

#include <optional>
#include <span>
#include <vector>

#include "reflectance/fit/fit_model.h"
#include "reflectance/fit/least_squares.h"
#include "reflectance/fit/pair_terms.h"
#include "reflectance/fit/scan_whitening.h"

namespace gonio::fit {

/// A reading as a fit takes it.
struct FitReading {
  std::size_t point = 0;  ///< index in the scan
  PairTerms pair;
  double value = 0.0;
  ReadingError error;
  /// Effects whose pattern is not known: their size stands in error.u_random.
  reflectance::SharedEffects unsure;
};

/// The model's free numbers, each as its place between its bounds.
class FreeNumbers {
 public:
  explicit FreeNumbers(const FitModel& model);
  [[nodiscard]] std::size_t size() const { return index_.size(); }
  /// All of the model's numbers, fixed ones at their start.
  [[nodiscard]] std::vector<double> all(std::span<const double> place) const;
  [[nodiscard]] std::vector<double> start() const;
  [[nodiscard]] std::size_t index(std::size_t k) const { return index_[k]; }
  [[nodiscard]] double range(std::size_t k) const;

 private:
  const FitModel* model_;
  std::vector<std::size_t> index_;
};

/// (model - value) / u of each reading, in the units of its random part alone.
[[nodiscard]] LeastSquares plain_problem(const FitModel& model, const FreeNumbers& numbers,
                                         std::span<const FitReading> readings);

/// The same whitened by the covariance. All arguments outlive what is returned.
[[nodiscard]] LeastSquares whitened_problem(const FitModel& model, const FreeNumbers& numbers,
                                            std::span<const FitReading> readings, const ScanWhitening& whitening);

/// The model at the readings.
[[nodiscard]] std::vector<double> fitted_values(const FitModel& model, std::span<const double> x,
                                                std::span<const FitReading> readings);

/// The readings' errors with the effects scaled from the values that were read to those that were fitted.
[[nodiscard]] std::vector<ReadingError> scaled_errors(std::span<const FitReading> readings,
                                                      std::span<const double> fitted);

}  // namespace gonio::fit
