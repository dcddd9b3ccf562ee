#include "reflectance/fit/fit_problem.h"

#include <algorithm>
#include <cmath>

namespace gonio::fit {
namespace {

// model - value, and the slopes by the places of the free numbers, row by row.
bool differences(const FitModel& model, const FreeNumbers& numbers, std::span<const FitReading> readings,
                 std::span<const double> place, std::span<double> r, std::span<double> slopes) {
  const std::vector<double> x = numbers.all(place);
  const std::size_t free = numbers.size();
  std::vector<double> all(x.size());
  double sum = 0.0;
  for (std::size_t j = 0; j < readings.size(); ++j) {
    r[j] = model.value(readings[j].pair, x, all) - readings[j].value;
    sum += r[j];
    if (slopes.empty()) continue;
    for (std::size_t k = 0; k < free; ++k) {
      const double slope = all[numbers.index(k)] * numbers.range(k);
      slopes[j * free + k] = std::isfinite(slope) ? slope : 0.0;
    }
  }
  return std::isfinite(sum);
}

}  // namespace

FreeNumbers::FreeNumbers(const FitModel& model) : model_(&model) {
  for (std::size_t k = 0; k < model.parameters().size(); ++k) {
    if (!model.parameters()[k].is_fixed) index_.push_back(k);
  }
}

double FreeNumbers::range(std::size_t k) const {
  const FitParameter& p = model_->parameters()[index_[k]];
  return p.most - p.least;
}

std::vector<double> FreeNumbers::all(std::span<const double> place) const {
  std::vector<double> x;
  for (const FitParameter& p : model_->parameters()) x.push_back(p.start);
  for (std::size_t k = 0; k < index_.size(); ++k) {
    const FitParameter& p = model_->parameters()[index_[k]];
    x[index_[k]] = std::clamp(p.least + place[k] * (p.most - p.least), p.least, p.most);
  }
  return x;
}

std::vector<double> FreeNumbers::start() const {
  std::vector<double> place;
  for (const std::size_t k : index_) {
    const FitParameter& p = model_->parameters()[k];
    place.push_back((p.start - p.least) / (p.most - p.least));
  }
  return place;
}

LeastSquares plain_problem(const FitModel& model, const FreeNumbers& numbers, std::span<const FitReading> readings) {
  return {.residuals = readings.size(),
          .parameters = numbers.size(),
          .evaluate = [&model, &numbers, readings](std::span<const double> place, std::span<double> r,
                                                   std::span<double> slopes) {
            if (!differences(model, numbers, readings, place, r, slopes)) return false;
            for (std::size_t j = 0; j < readings.size(); ++j) {
              r[j] /= readings[j].error.u_random;
              for (std::size_t k = 0; k < numbers.size() && !slopes.empty(); ++k) {
                slopes[j * numbers.size() + k] /= readings[j].error.u_random;
              }
            }
            return true;
          }};
}

LeastSquares whitened_problem(const FitModel& model, const FreeNumbers& numbers, std::span<const FitReading> readings,
                              const ScanWhitening& whitening) {
  return {.residuals = whitening.size(),
          .parameters = numbers.size(),
          .evaluate = [&model, &numbers, &whitening, readings](std::span<const double> place, std::span<double> r,
                                                               std::span<double> slopes) {
            const std::size_t free = numbers.size();
            std::vector<double> bare(readings.size());
            std::vector<double> bare_slopes(slopes.empty() ? 0 : readings.size() * free);
            if (!differences(model, numbers, readings, place, bare, bare_slopes)) return false;
            whitening.whiten(bare, r);
            std::vector<double> column(slopes.empty() ? 0 : whitening.size());
            for (std::size_t k = 0; k < free && !slopes.empty(); ++k) {
              for (std::size_t j = 0; j < readings.size(); ++j) bare[j] = bare_slopes[j * free + k];
              whitening.whiten(bare, column);
              for (std::size_t j = 0; j < column.size(); ++j) slopes[j * free + k] = column[j];
            }
            return true;
          }};
}

std::vector<double> fitted_values(const FitModel& model, std::span<const double> x,
                                  std::span<const FitReading> readings) {
  std::vector<double> values;
  std::vector<double> slopes(x.size());
  for (const FitReading& reading : readings) values.push_back(model.value(reading.pair, x, slopes));
  return values;
}

// Where a value stands out of its noise, its shared effects are taken as proportional to it, and its noise as that of
// counted light, to its root.
std::vector<ReadingError> scaled_errors(std::span<const FitReading> readings, std::span<const double> fitted) {
  constexpr double kProportional = 5.0;
  constexpr double kLight = 20.0;
  std::vector<ReadingError> errors;
  for (std::size_t j = 0; j < readings.size(); ++j) {
    const FitReading& reading = readings[j];
    ReadingError& error = errors.emplace_back(reading.error);
    const double size = std::abs(reading.value);
    if (size <= kProportional * error.u_random) continue;
    const double ratio = std::clamp(fitted[j] / reading.value, 0.5, 2.0);
    error.shared = reflectance::SharedEffects();
    error.shared.add(reading.error.shared, ratio);
    if (size > kLight * error.u_random) error.u_random *= std::sqrt(ratio);
  }
  return errors;
}

}  // namespace gonio::fit
