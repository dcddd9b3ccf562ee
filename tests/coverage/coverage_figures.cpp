#include "tests/coverage/coverage_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace gonio::coverage {
namespace {

constexpr double kLevel = 0.9545;

double square(double x) {
  return x * x;
}

std::uint8_t bit(Stratum stratum) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(stratum));
}

std::uint8_t strata_of(const Geometry& g, double truth, double expanded, double lobe_from) {
  const double theta_r = in_degrees(g.theta_r) + 0.01;  // 60 deg is 60 deg, whatever its last bit
  std::uint8_t strata = bit(theta_r < 30.0 ? Stratum::Near : theta_r < 60.0 ? Stratum::Middle : Stratum::Far);
  if (truth >= lobe_from) strata |= bit(Stratum::Lobe);
  if (std::abs(truth) <= expanded) strata |= bit(Stratum::NearZero);
  return strata;
}

std::int64_t key_of(Angle a) {
  return std::llround(in_degrees(a) * 10.0);
}

// Points of one theta_i as rings of theta_r, each with the projected solid angle half way to its neighbours; the value
// of a ring is the mean of its points. The quadrature is the same for truth and measurement: what it leaves out is not
// calibration's.
std::map<std::int64_t, std::vector<std::pair<const calibration::CalibratedPoint*, double>>> weights_of(
    const calibration::CalibratedScan& scan) {
  std::map<std::int64_t, std::map<std::int64_t, std::vector<const calibration::CalibratedPoint*>>> rings;
  for (const auto& point : scan.points)
    rings[key_of(point.geometry.theta_i)][key_of(point.geometry.theta_r)].push_back(&point);
  std::map<std::int64_t, std::vector<std::pair<const calibration::CalibratedPoint*, double>>> weights;
  for (const auto& [theta_i, by_theta_r] : rings) {
    for (auto ring = by_theta_r.begin(); ring != by_theta_r.end(); ++ring) {
      const auto edge = [&](auto a, auto b) { return degrees(0.05 * static_cast<double>(a->first + b->first)).si(); };
      const auto next = std::next(ring);
      const double low = ring == by_theta_r.begin() ? 0.0 : edge(std::prev(ring), ring);
      const double high =
          next == by_theta_r.end() ? degrees(0.1 * static_cast<double>(ring->first)).si() : edge(ring, next);
      const double projected = std::numbers::pi * (square(std::sin(high)) - square(std::sin(low)));
      for (const auto* point : ring->second) {
        weights[theta_i].emplace_back(point, projected / static_cast<double>(ring->second.size()));
      }
    }
  }
  return weights;
}

double uncorrelated_u(const std::vector<calibration::SumTerm>& terms) {
  double u2 = 0.0;
  for (const auto& term : terms) u2 += square(term.weight * term.budget->u.si());
  return std::sqrt(u2);
}

// The mean of per-repetition ratios sum/count with its standard error by repetition.
Share share_of(const std::vector<double>& shares) {
  const auto n = static_cast<double>(shares.size());
  if (shares.size() < 2) return {.value = shares.empty() ? 0.0 : shares.front(), .standard_error = 0.0};
  double mean = 0.0;
  for (const double s : shares) mean += s / n;
  double variance = 0.0;
  for (const double s : shares) variance += square(s - mean) / (n - 1.0);
  return {.value = mean, .standard_error = std::sqrt(variance / n)};
}

struct Sums {
  double n = 0.0, held = 0.0, z2 = 0.0, error2 = 0.0, half = 0.0, value = 0.0;
  void add(const ValueOutcome& v) {
    n += 1.0;
    held += v.is_held() ? 1.0 : 0.0;
    z2 += square(v.error / v.u);
    error2 += square(v.error);
    half += 0.5 * v.expanded;
    value += v.value;
  }
  [[nodiscard]] double width() const { return half / n / std::sqrt(error2 / n); }
  [[nodiscard]] double rms_z() const { return n > 0.0 ? std::sqrt(z2 / n) : 0.0; }
};

double mean_width(const std::map<std::int32_t, Sums>& points) {
  double sum = 0.0;
  for (const auto& [index, sums] : points) sum += sums.width() / static_cast<double>(points.size());
  return sum;
}

double held_share(const std::vector<ValueOutcome>& values) {
  double held = 0.0;
  for (const ValueOutcome& v : values) held += v.is_held() ? 1.0 : 0.0;
  return held / static_cast<double>(values.size());
}

double median_relative(const std::map<std::int32_t, Sums>& points) {
  std::vector<double> relative;
  for (const auto& [index, sums] : points) relative.push_back(2.0 * sums.half / std::abs(sums.value));
  if (relative.empty()) return 0.0;
  const auto middle = relative.begin() + static_cast<std::ptrdiff_t>(relative.size() / 2);
  std::ranges::nth_element(relative, middle);
  return *middle;
}

}  // namespace

const char* stratum_name(Stratum stratum) {
  constexpr std::array<const char*, kStrata> kNames = {"theta_r below 30", "theta_r 30 to 60", "theta_r from 60",
                                                       "in the lobe", "near zero"};
  return kNames[static_cast<std::size_t>(stratum)];
}

bool ValueOutcome::is_held() const {
  return error <= below && -error <= above;
}

RepetitionOutcome outcome_of(const calibration::CalibratedScan& scan, const sim::Truth& truth, std::size_t planned,
                             bool has_lobe, bool correlation) {
  RepetitionOutcome outcome{.points = {}, .rho = {}, .refused = {}, .planned = planned};
  for (const auto& refused : scan.refused) outcome.refused.push_back(refused.reason.code);
  double largest = 0.0;
  for (const auto& point : scan.points) largest = std::max(largest, truth.sample(point.geometry).si());
  const double lobe_from = has_lobe ? 0.5 * largest : INFINITY;
  for (const auto& point : scan.points) {
    const double true_value = truth.sample(point.geometry).si();
    const double expanded = point.budget.expanded.si();
    const bool is_drawn = point.budget.method == calibration::BudgetMethod::MonteCarlo;
    outcome.points.push_back({.point = point.point_index,
                              .error = point.value.si() - true_value,
                              .u = point.budget.u.si(),
                              .expanded = expanded,
                              .below = is_drawn ? point.budget.below.si() : expanded,
                              .above = is_drawn ? point.budget.above.si() : expanded,
                              .value = point.value.si(),
                              .strata = strata_of(point.geometry, true_value, expanded, lobe_from)});
  }
  for (const auto& [theta_i, weighted] : weights_of(scan)) {
    std::vector<calibration::SumTerm> terms;
    double true_sum = 0.0;
    for (const auto& [point, weight] : weighted) {
      terms.push_back({.weight = weight, .value = point->value, .budget = &point->budget});
      true_sum += weight * truth.sample(point->geometry).si();
    }
    const auto sum = calibration::weighted_sum(scan.components, terms);
    const double u = correlation ? sum.u.si() : uncorrelated_u(terms);
    const double expanded = correlation ? sum.expanded.si() : 2.0 * u;
    outcome.rho.push_back({.point = static_cast<std::int32_t>(theta_i),
                           .error = sum.value.si() - true_sum,
                           .u = u,
                           .expanded = expanded,
                           .below = expanded,
                           .above = expanded,
                           .value = sum.value.si(),
                           .strata = 0});
  }
  return outcome;
}

CoverageFigures figures_of(const std::vector<RepetitionOutcome>& repetitions) {
  CoverageFigures figures{.repetitions = static_cast<int>(repetitions.size())};
  std::vector<double> shares, rho_shares;
  std::map<std::int32_t, Sums> points, rho;
  std::array<Sums, kStrata> strata{};
  Sums all, all_rho;
  double planned = 0.0, refused = 0.0;
  for (const RepetitionOutcome& repetition : repetitions) {
    planned += static_cast<double>(repetition.planned);
    refused += static_cast<double>(repetition.refused.size());
    for (const ErrorCode code : repetition.refused) ++figures.refused_for[code];
    for (const ValueOutcome& v : repetition.points) {
      points[v.point].add(v);
      all.add(v);
      for (std::size_t s = 0; s < kStrata; ++s) {
        if ((v.strata & bit(static_cast<Stratum>(s))) != 0) strata[s].add(v);
      }
    }
    for (const ValueOutcome& v : repetition.rho) {
      rho[v.point].add(v);
      all_rho.add(v);
    }
    if (!repetition.points.empty()) shares.push_back(held_share(repetition.points));
    if (!repetition.rho.empty()) rho_shares.push_back(held_share(repetition.rho));
  }
  figures.held = share_of(shares);
  figures.rho_held = share_of(rho_shares);
  figures.rms_z = all.rms_z();
  figures.rho_rms_z = all_rho.rms_z();
  figures.width = mean_width(points);
  figures.rho_width = mean_width(rho);
  figures.least_point = 1.0;
  for (const auto& [index, sums] : points) figures.least_point = std::min(figures.least_point, sums.held / sums.n);
  figures.relative_expanded = median_relative(points);
  figures.refused = planned > 0.0 ? refused / planned : 0.0;
  for (const Sums& s : strata) {
    figures.strata.push_back({.values_per_repetition = s.n / static_cast<double>(repetitions.size()),
                              .held = s.n > 0.0 ? s.held / s.n : 0.0,
                              .rms_z = s.rms_z()});
  }
  return figures;
}

Claim Claim::for_few(int repetitions) {
  const double n = repetitions;
  const double binomial = 3.0 * std::sqrt(kLevel * (1.0 - kLevel) / n);
  const double rms = 3.0 / std::sqrt(2.0 * n);  // relative, of a deviation of n normal draws
  Claim claim;
  claim.held_margin = std::max(claim.held_margin, binomial);
  claim.rho_margin = claim.held_margin;
  claim.rms_low *= 1.0 - rms;
  claim.rms_high *= 1.0 + rms;
  claim.width_at_most *= 1.0 + rms;
  return claim;
}

std::vector<std::string> failures(const CoverageFigures& figures, const Claim& claim) {
  std::vector<std::string> found;
  const auto demand = [&](bool holds, const char* what, double seen, const std::string& limit) {
    if (!holds) found.push_back(fmt::format("{}: {:.4f}, demanded {}", what, seen, limit));
  };
  const auto demand_share = [&](const char* what, double seen, double margin) {
    demand(std::abs(seen - kLevel) <= margin, what, seen, fmt::format("{:.4f} +- {:.4f}", kLevel, margin));
  };
  const auto demand_rms = [&](const char* what, double seen) {
    demand(seen >= claim.rms_low && seen <= claim.rms_high, what, seen,
           fmt::format("{:.3f} to {:.3f}", claim.rms_low, claim.rms_high));
  };
  demand_share("share held of points", figures.held.value, claim.held_margin);
  demand_share("share held of rho_dh", figures.rho_held.value, claim.rho_margin);
  for (std::size_t s = 0; s < figures.strata.size(); ++s) {
    if (figures.strata[s].values_per_repetition < 0.5) continue;
    demand_rms(fmt::format("RMS (value - truth)/u {}", stratum_name(static_cast<Stratum>(s))).c_str(),
               figures.strata[s].rms_z);
  }
  const std::string narrow = fmt::format("at most {:.2f}", claim.width_at_most);
  demand(figures.width <= claim.width_at_most, "mean(U/2)/RMS(value - truth)", figures.width, narrow);
  demand(figures.refused <= claim.refused_at_most, "share refused", figures.refused,
         fmt::format("at most {:.2f}", claim.refused_at_most));
  return found;
}

}  // namespace gonio::coverage
