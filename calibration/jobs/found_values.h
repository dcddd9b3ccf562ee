#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::calibration {

/// One value that a job has found, in the unit that its name ends in or that `unit` says.
struct FoundValue {
  std::string name;  ///< "zero_theta_i_deg", "linearity_1"
  std::string unit;  ///< "deg", "s", "1"
  double value = 0.0;
  friend bool operator==(const FoundValue&, const FoundValue&) = default;
};

/// What a job has found: values that were fitted together, with one covariance.
struct FoundValues {
  std::vector<FoundValue> values;
  std::vector<double> covariance;  ///< of the values, row by row: size^2 numbers, each in the product of two units
  std::string note;                ///< what a person should know of it: how it fitted, what it could not see

  /// Standard uncertainty of a value by its place.
  [[nodiscard]] double u(std::size_t place) const;
  [[nodiscard]] double correlation(std::size_t a, std::size_t b) const;
  /// The place of a name; none.
  [[nodiscard]] std::optional<std::size_t> place_of(std::string_view name) const;
  friend bool operator==(const FoundValues&, const FoundValues&) = default;
};

/// Values that share nothing: their variances, one each in `covariance`, become the diagonal of the whole.
void spread_diagonal(FoundValues& found);

}  // namespace gonio::calibration
