#include "calibration/jobs/found_values.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace gonio::calibration {

double FoundValues::u(std::size_t place) const {
  return std::sqrt(std::max(0.0, covariance[place * values.size() + place]));
}

double FoundValues::correlation(std::size_t a, std::size_t b) const {
  const double scale = u(a) * u(b);
  return scale > 0.0 ? covariance[a * values.size() + b] / scale : 0.0;
}

std::optional<std::size_t> FoundValues::place_of(std::string_view name) const {
  const auto same = std::ranges::find(values, name, &FoundValue::name);
  if (same == values.end()) return std::nullopt;
  return static_cast<std::size_t>(same - values.begin());
}

void spread_diagonal(FoundValues& found) {
  const std::size_t n = found.values.size();
  std::vector<double> covariance(n * n, 0.0);
  for (std::size_t k = 0; k < n; ++k) covariance[k * n + k] = found.covariance[k];
  found.covariance = std::move(covariance);
}

}  // namespace gonio::calibration
