#include "reflectance/fit/fit_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "reflectance/fit/fit_problem.h"
#include "reflectance/fit/fit_statistics.h"
#include "reflectance/sampling/random_stream.h"

namespace gonio::fit {
namespace {

using reflectance::MeasuredPoint;
using reflectance::MeasuredScan;

Error refused_fit(const MeasuredScan& scan, const FitModel& model, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("fit the model \"{}\" to the scan \"{}\"", model.name(), scan.name),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

Result<void> check_request(const MeasuredScan& scan, const FitModel& model, const FitOptions& options) {
  GONIO_TRY(reflectance::check(scan));
  if (model.free_count() == 0) return failure(refused_fit(scan, model, "no free number", "at least one"));
  if (options.starts < 1 || options.starts > 100) {
    return failure(refused_fit(scan, model, fmt::format("{} starts", options.starts), "1 to 100"));
  }
  if (options.most_iterations < 1) {
    return failure(refused_fit(scan, model, fmt::format("{} iterations", options.most_iterations), "at least one"));
  }
  return {};
}

void add_errors(const MeasuredScan& scan, const MeasuredPoint& p, FitReading& reading) {
  std::vector<reflectance::SharedEffect> known;
  std::vector<reflectance::SharedEffect> unsure;
  for (const reflectance::SharedEffect& e : p.shared) {
    (scan.components[e.component].is_pattern_known ? known : unsure).push_back(e);
  }
  reading.unsure = reflectance::SharedEffects(unsure);
  reading.error = {.u_random = std::hypot(p.u_random.si(), size_of(reading.unsure)),
                   .shared = reflectance::SharedEffects(known)};
}

Result<std::vector<FitReading>> readings_of(const MeasuredScan& scan, const FitModel& model, FitWeights weights) {
  std::vector<FitReading> readings;
  for (const std::size_t k : reflectance::usable_points(scan)) {
    const MeasuredPoint& p = scan.points[k];
    if (weights == FitWeights::Stated && !(p.u_random > Brdf{})) {
      return failure(refused_fit(scan, model, fmt::format("point {}: u_random 0 /sr", k),
                                 "above 0; or even weights, with u from the scatter"));
    }
    FitReading reading{
        .point = k,
        .pair = pair_terms(reflectance::incident_direction(p.geometry), reflectance::reflected_direction(p.geometry)),
        .value = p.value.si(),
        .error = {.u_random = 1.0, .shared = {}}};
    if (weights == FitWeights::Stated) add_errors(scan, p, reading);
    readings.push_back(std::move(reading));
  }
  return readings;
}

// Enough of the readings to find the right basin.
std::vector<FitReading> thinned(std::span<const FitReading> readings) {
  constexpr std::size_t kEnough = 500;
  const std::size_t step = readings.size() / kEnough + 1;
  std::vector<FitReading> few;
  for (std::size_t k = 0; k < readings.size(); k += step) few.push_back(readings[k]);
  return few;
}

std::vector<std::vector<double>> start_places(const FreeNumbers& numbers, const FitOptions& options) {
  std::vector<std::vector<double>> starts{numbers.start()};
  const reflectance::RandomStream stream(options.seed);
  for (int s = 1; s < options.starts; ++s) {
    std::vector<double>& start = starts.emplace_back();
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const auto draw = static_cast<std::uint64_t>(s) * 64 + k;
      start.push_back(0.02 + 0.96 * stream.point(draw).u);
    }
  }
  return starts;
}

struct Basin {
  LeastSquaresMinimum best;
  int agreeing = 0;
};

Result<Basin> best_basin(const FitModel& model, const FreeNumbers& numbers, std::span<const FitReading> readings,
                         const FitOptions& options) {
  const LeastSquares problem = plain_problem(model, numbers, readings);
  std::vector<LeastSquaresMinimum> minima;
  Error why;
  for (std::vector<double>& start : start_places(numbers, options)) {
    Result<LeastSquaresMinimum> found = minimise(problem, std::move(start), options.most_iterations);
    if (found) minima.push_back(*std::move(found));
    if (!found) why = std::move(found).error();
  }
  if (minima.empty()) return failure(std::move(why));
  const auto best = std::ranges::min_element(minima, {}, &LeastSquaresMinimum::sum_of_squares);
  Basin basin{.best = *best};
  for (const LeastSquaresMinimum& m : minima) {
    constexpr double kSame = 1e-3;
    bool is_same = true;
    for (std::size_t k = 0; k < numbers.size(); ++k) is_same = is_same && std::abs(m.x[k] - best->x[k]) < kSame;
    basin.agreeing += is_same ? 1 : 0;
  }
  return basin;
}

// The minimum with the covariance, whose effects follow the fitted values.
struct FinalFit {
  LeastSquaresMinimum minimum;
  ScanWhitening whitening;
};

Result<FinalFit> final_fit(const FitModel& model, const FreeNumbers& numbers, std::span<const FitReading> readings,
                           std::vector<double> place, const FitOptions& options) {
  constexpr int kPasses = 3;
  for (int pass = 0;; ++pass) {
    const std::vector<double> fitted = fitted_values(model, numbers.all(place), readings);
    const bool is_stated = options.weights == FitWeights::Stated;
    std::vector<ReadingError> errors;
    if (is_stated)
      errors = scaled_errors(readings, fitted);
    else
      errors.assign(readings.size(), {.u_random = 1.0, .shared = {}});
    Result<ScanWhitening> whitening = ScanWhitening::make(errors);
    if (!whitening) return failure(std::move(whitening).error());
    const LeastSquares problem = whitened_problem(model, numbers, readings, *whitening);
    Result<LeastSquaresMinimum> found = minimise(problem, place, options.most_iterations);
    if (!found) return failure(std::move(found).error());
    if (pass + 1 == kPasses || !is_stated) return FinalFit{*std::move(found), *std::move(whitening)};
    place = found->x;
  }
}

}  // namespace

Result<FitResult> fit_scan(const MeasuredScan& scan, const FitModel& model, const FitOptions& options) {
  GONIO_TRY(check_request(scan, model, options));
  const Result<std::vector<FitReading>> readings = readings_of(scan, model, options.weights);
  if (!readings) return failure(readings.error());
  const FreeNumbers numbers(model);
  const std::vector<FitReading> few = thinned(*readings);
  Result<Basin> basin = best_basin(model, numbers, few, options);
  if (!basin) return failure(std::move(basin).error());
  Result<FinalFit> fit = final_fit(model, numbers, *readings, basin->best.x, options);
  if (!fit) return failure(std::move(fit).error());
  Result<reflectance::Surface> surface = model.surface(numbers.all(fit->minimum.x));
  if (!surface) return failure(std::move(surface).error());
  FitResult result{.model = model, .scan = scan.name, .points = readings->size(), .surface = *std::move(surface)};
  result.has_even_weights = options.weights == FitWeights::Even;
  result.has_converged = fit->minimum.has_converged;
  result.starts = options.starts;
  result.agreeing_starts = basin->agreeing;
  add_statistics(result, scan, numbers, *readings, fit->minimum.x, fit->whitening);
  return result;
}

}  // namespace gonio::fit
