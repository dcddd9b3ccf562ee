#include "reflectance/fit/rank_fits.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace gonio::fit {
namespace {

Error not_comparable(std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput, .tried = "rank fits", .seen = std::move(seen), .limit = std::move(limit)};
}

// A tenth of u up, or down where the bound is in the way.
double shift_of(const FittedParameter& p) {
  const double step = std::max(0.1 * p.u, 1e-9 * (p.most - p.least));
  if (p.value + step <= p.most) return step;
  return -std::min(step, p.value - p.least);
}

Result<reflectance::CapModel::Parameter> cap_parameter(const FitResult& fit, std::size_t k) {
  std::vector<double> x;
  for (const FittedParameter& p : fit.parameters) x.push_back(p.value);
  const double shift = shift_of(fit.parameters[k]);
  x[k] += shift;
  Result<reflectance::Surface> shifted = fit.model.surface(x);
  if (!shifted) return failure(std::move(shifted).error());
  return reflectance::CapModel::Parameter{
      .shifted = *std::move(shifted), .shift = shift, .per_reading = fit.parameters[k].per_reading};
}

// RMS of reading - fitted over RMS of the fitted; none where chance explains it.
double lack_of_fit(const FitResult& fit) {
  if (fit.fits()) return 0.0;
  double values = 0.0;
  for (const FitResidual& one : fit.residuals) values += one.fitted.si() * one.fitted.si();
  const double rms_fitted = std::sqrt(values / static_cast<double>(std::max<std::size_t>(1, fit.residuals.size())));
  return rms_fitted > 0.0 ? fit.rms_difference / rms_fitted : 1.0;
}

// Of models that all fail, Akaike's weights give everything to one: they take what is left for noise, of which each
// reading has its own. It is a pattern that goes through all of them: readings as good as two, of unknown variance,
// have a likelihood that goes as 1 / chi2.
std::vector<double> weights_of(std::span<const FitResult> fits, const std::vector<RankedFit>& ranks) {
  const FitResult& best = fits[ranks.front().fit];
  std::vector<double> weights;
  double sum = 0.0;
  for (const RankedFit& rank : ranks) {
    const double chi2 = fits[rank.fit].chi2;
    const bool is_alike = chi2 <= best.chi2;
    weights.push_back(best.fits() ? rank.weight : (is_alike ? 1.0 : best.chi2 / chi2));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace

Result<std::vector<RankedFit>> rank_fits(std::span<const FitResult> fits) {
  if (fits.empty()) return failure(not_comparable("no fits", "at least one"));
  std::vector<RankedFit> ranks;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const FitResult& fit = fits[k];
    if (fit.points != fits[0].points || fit.has_even_weights != fits[0].has_even_weights) {
      return failure(not_comparable(fmt::format("\"{}\" of {} points and \"{}\" of {}", fits[0].model.name(),
                                                fits[0].points, fit.model.name(), fit.points),
                                    "fits of the same readings, weighted alike"));
    }
    ranks.push_back({.fit = k, .model = fit.model.name(), .aicc = fit.aicc});
  }
  std::ranges::stable_sort(ranks, {}, &RankedFit::aicc);
  double sum = 0.0;
  for (RankedFit& rank : ranks) {
    // With too few points for any of them all are infinite: then they are alike.
    rank.delta = std::isinf(ranks.front().aicc) ? 0.0 : rank.aicc - ranks.front().aicc;
    rank.weight = std::exp(-0.5 * rank.delta);
    sum += rank.weight;
  }
  for (RankedFit& rank : ranks) rank.weight /= sum;
  return ranks;
}

Result<std::vector<FitResult>> fit_models(const reflectance::MeasuredScan& scan, std::span<const FitModel> models,
                                          const FitOptions& options) {
  std::vector<FitResult> fits;
  for (const FitModel& model : models) {
    Result<FitResult> fit = fit_scan(scan, model, options);
    if (!fit) return failure(std::move(fit).error());
    fits.push_back(*std::move(fit));
  }
  return fits;
}

Result<reflectance::CapModel> cap_of(std::span<const FitResult> fits) {
  const Result<std::vector<RankedFit>> ranks = rank_fits(fits);
  if (!ranks) return failure(ranks.error());
  const FitResult& best = fits[ranks->front().fit];
  reflectance::CapModel cap{
      .surface = best.surface, .parameters = {}, .rivals = {}, .u_lack_of_fit = lack_of_fit(best)};
  for (std::size_t k = 0; k < best.parameters.size(); ++k) {
    if (best.parameters[k].is_fixed) continue;
    Result<reflectance::CapModel::Parameter> parameter = cap_parameter(best, k);
    if (!parameter) return failure(std::move(parameter).error());
    cap.parameters.push_back(*std::move(parameter));
  }
  const std::vector<double> weights = weights_of(fits, *ranks);
  for (std::size_t r = 1; r < ranks->size(); ++r) {
    constexpr double kCounts = 1e-6;
    if (weights[r] > kCounts) cap.rivals.push_back({.surface = fits[(*ranks)[r].fit].surface, .weight = weights[r]});
  }
  return cap;
}

}  // namespace gonio::fit
