#include "reflectance/fit/fit_statistics.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "reflectance/check/chi_square.h"
#include "reflectance/fit/dense_algebra.h"

namespace gonio::fit {
namespace {

// What a number that is only known to lie within its bounds has for 1/variance, its range being 1.
constexpr double kKnownByBounds = 12.0;

// The numbers' covariance in units of their ranges, and who takes part in what the data do not tell.
struct Covariance {
  SquareMatrix matrix;
  std::vector<bool> is_determined;
};

Covariance covariance_of(std::span<const double> slopes, std::size_t free, double variance_scale) {
  SquareMatrix information(free);
  for (std::size_t row = 0; row * free < slopes.size(); ++row) {
    for (std::size_t a = 0; a < free; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        information.at(a, b) += slopes[row * free + a] * slopes[row * free + b] / variance_scale;
      }
    }
  }
  const SymmetricEigen eigen = symmetric_eigen(information);
  Covariance covariance{.matrix = SquareMatrix(free), .is_determined = std::vector<bool>(free, true)};
  for (std::size_t k = 0; k < free; ++k) {
    constexpr double kTakesPart = 0.05;
    const bool is_known = eigen.values[k] > kKnownByBounds;
    const double variance = 1.0 / std::max(eigen.values[k], kKnownByBounds);
    const std::vector<double>& v = eigen.vectors[k];
    for (std::size_t a = 0; a < free; ++a) {
      if (!is_known && v[a] * v[a] > kTakesPart) covariance.is_determined[a] = false;
      for (std::size_t b = 0; b < free; ++b) covariance.matrix.at(a, b) += variance * v[a] * v[b];
    }
  }
  return covariance;
}

// An error of unknown pattern is in the covariance as if it were each reading's own; it may as well be one.
void add_unsure(SquareMatrix& covariance, std::span<const double> slopes, const ScanWhitening& whitening,
                std::span<const FitReading> readings) {
  std::map<std::uint32_t, std::vector<double>> moved;  // by component: what one standard deviation does to the numbers
  const SquareMatrix as_random = covariance;
  const std::size_t free = covariance.size;
  for (std::size_t j = 0; j < readings.size(); ++j) {
    for (const auto& entry : readings[j].unsure.entries()) {
      std::vector<double>& sum = moved.try_emplace(entry.component, free, 0.0).first->second;
      for (std::size_t a = 0; a < free; ++a) {
        for (std::size_t b = 0; b < free; ++b) {
          sum[a] += as_random.at(a, b) * slopes[j * free + b] / whitening.u_random(j) * entry.per_sd;
        }
      }
    }
  }
  for (const auto& [component, sum] : moved) {
    for (std::size_t a = 0; a < free; ++a) {
      for (std::size_t b = 0; b < free; ++b) covariance.at(a, b) += sum[a] * sum[b];
    }
  }
}

void add_correlation(FitResult& result, const SquareMatrix& covariance) {
  for (std::size_t a = 0; a < covariance.size; ++a) {
    for (std::size_t b = 0; b < covariance.size; ++b) {
      const double both = std::sqrt(covariance.at(a, a) * covariance.at(b, b));
      result.correlation.push_back(both > 0.0 ? covariance.at(a, b) / both : 0.0);
    }
  }
}

// The first rows of the whitened slopes are J^T V^-1 in units of u: what the numbers make of each reading.
std::vector<double> dependence(std::size_t k, const SquareMatrix& covariance, std::span<const double> slopes,
                               const ScanWhitening& whitening, std::span<const FitReading> readings,
                               std::size_t points) {
  std::vector<double> per_reading(points, 0.0);
  const std::size_t free = covariance.size;
  for (std::size_t j = 0; j < readings.size(); ++j) {
    double sum = 0.0;
    for (std::size_t a = 0; a < free; ++a) sum += covariance.at(k, a) * slopes[j * free + a];
    per_reading[readings[j].point] = sum / whitening.u_random(j);
  }
  return per_reading;
}

void add_parameters(FitResult& result, const FreeNumbers& numbers, std::span<const double> place) {
  const std::vector<double> x = numbers.all(place);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const FitParameter& p = result.model.parameters()[k];
    result.parameters.push_back(
        {.name = p.name, .value = x[k], .least = p.least, .most = p.most, .is_fixed = p.is_fixed});
  }
}

void add_uncertainties(FitResult& result, const FreeNumbers& numbers, std::span<const double> place,
                       const Covariance& covariance) {
  constexpr double kAtBound = 1e-7;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    FittedParameter& p = result.parameters[numbers.index(k)];
    result.free_names.push_back(p.name);
    p.u = std::sqrt(covariance.matrix.at(k, k)) * numbers.range(k);
    p.U = 2.0 * p.u;
    p.is_at_bound = place[k] < kAtBound || place[k] > 1.0 - kAtBound;
    p.is_determined = covariance.is_determined[k];
  }
  add_correlation(result, covariance.matrix);
}

void add_residuals(FitResult& result, const reflectance::MeasuredScan& scan, std::span<const FitReading> readings,
                   std::span<const double> x, std::span<const double> z) {
  const std::vector<double> fitted = fitted_values(result.model, x, readings);
  double squares = 0.0;
  for (std::size_t j = 0; j < readings.size(); ++j) {
    const double difference = readings[j].value - fitted[j];
    squares += difference * difference;
    result.residuals.push_back({.point = readings[j].point,
                                .geometry = scan.points[readings[j].point].geometry,
                                .fitted = per_steradian(fitted[j]),
                                .difference = per_steradian(difference),
                                .z = -z[j]});
  }
  result.rms_difference = std::sqrt(squares / static_cast<double>(readings.size()));
}

void add_shifts(FitResult& result, const reflectance::MeasuredScan& scan, const ScanWhitening& whitening,
                std::span<const double> z) {
  for (std::size_t k = 0; whitening.readings() + k < whitening.size(); ++k) {
    result.shifts.push_back({.component = scan.components[whitening.component(k)].name,
                             .standard_deviations = -z[whitening.readings() + k]});
  }
  std::ranges::stable_sort(result.shifts, std::ranges::greater(),
                           [](const SharedShift& s) { return std::abs(s.standard_deviations); });
}

// With stated weights -2 ln L = chi2 + const; with even ones the variance is a number of the fit, too.
double aicc_of(const FitResult& result, std::size_t free) {
  const auto n = static_cast<double>(result.points);
  const double numbers = static_cast<double>(free) + (result.has_even_weights ? 1.0 : 0.0);
  const double misfit = result.has_even_weights ? n * std::log(std::max(1e-300, result.chi2 / n)) : result.chi2;
  const double left = n - numbers - 1.0;
  const double correction = left > 0.0 ? 2.0 * numbers * (numbers + 1.0) / left : INFINITY;
  return misfit + 2.0 * numbers + correction;
}

}  // namespace

void add_statistics(FitResult& result, const reflectance::MeasuredScan& scan, const FreeNumbers& numbers,
                    std::span<const FitReading> readings, std::span<const double> place,
                    const ScanWhitening& whitening) {
  const std::size_t free = numbers.size();
  const LeastSquares problem = whitened_problem(result.model, numbers, readings, whitening);
  std::vector<double> z(whitening.size());
  std::vector<double> slopes(whitening.size() * free);
  problem.evaluate(place, z, slopes);
  for (const double value : z) result.chi2 += value * value;
  result.degrees_of_freedom = readings.size() > free ? readings.size() - free : 0;
  const auto freedom = static_cast<double>(result.degrees_of_freedom);
  double variance_scale = 1.0;
  if (result.has_even_weights) {
    variance_scale = std::max(1e-300, result.chi2 / std::max(1.0, freedom));
  } else if (result.degrees_of_freedom > 0) {
    result.p_value = reflectance::chi_square_probability(result.chi2, freedom);
  }
  result.aicc = aicc_of(result, free);
  const Covariance covariance = covariance_of(slopes, free, variance_scale);
  Covariance whole = covariance;
  add_unsure(whole.matrix, slopes, whitening, readings);
  add_parameters(result, numbers, place);
  add_uncertainties(result, numbers, place, whole);
  for (std::size_t k = 0; k < free; ++k) {
    FittedParameter& p = result.parameters[numbers.index(k)];
    p.per_reading = dependence(k, covariance.matrix, slopes, whitening, readings, scan.points.size());
    for (double& d : p.per_reading) d *= numbers.range(k) / variance_scale;
  }
  add_residuals(result, scan, readings, numbers.all(place), z);
  add_shifts(result, scan, whitening, z);
}

}  // namespace gonio::fit
