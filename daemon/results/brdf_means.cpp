#include "daemon/results/brdf_means.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "daemon/results/calibration_desk.h"

namespace gonio::daemon {
namespace {

struct Mean {
  double value = 0.0;
  double random_variance = 0.0;
  std::map<std::size_t, double> shared;  // by component, per standard deviation of it
};

// Of the others the signs at the points are not known: their sizes are added, so that nothing cancels.
bool has_signs(const NewBrdf& brdf, std::size_t component) {
  return std::ranges::none_of(brdf.sizes_only, [&](std::uint32_t place) { return place == component; });
}

Mean mean_of_rows(const NewBrdf& brdf, const std::vector<std::size_t>& group) {
  const double weight = std::numbers::pi / static_cast<double>(group.size());
  Mean mean;
  for (const std::size_t place : group) {
    const BrdfRow& row = brdf.rows[place];
    mean.value += weight * row.value_per_sr;
    mean.random_variance += std::pow(weight * row.u_random_per_sr, 2);
    for (std::size_t k = 0; k + 1 < row.sensitivities_per_sr.size(); k += 2) {
      const auto component = static_cast<std::size_t>(row.sensitivities_per_sr[k]);
      const double effect = weight * row.sensitivities_per_sr[k + 1];
      mean.shared[component] += has_signs(brdf, component) ? effect : std::abs(effect);
    }
  }
  return mean;
}

double own_variance(const NewBrdf& brdf, const Mean& mean) {
  double own = mean.random_variance;
  for (const auto& [component, effect] : mean.shared) {
    const bool is_known = component < brdf.component_names.size();
    if (is_known && is_drawn_anew(brdf.component_names[component])) own += effect * effect;
  }
  return own;
}

double shared_covariance(const Mean& a, const Mean& b) {
  double sum = 0.0;
  for (const auto& [component, effect] : a.shared) {
    const auto other = b.shared.find(component);
    if (other != b.shared.end()) sum += effect * other->second;
  }
  return sum;
}

}  // namespace

BrdfMeans means_of(const NewBrdf& brdf, const std::vector<std::vector<std::size_t>>& groups) {
  std::vector<Mean> means;
  for (const auto& group : groups) means.push_back(mean_of_rows(brdf, group));
  BrdfMeans all;
  for (std::size_t a = 0; a < means.size(); ++a) {
    all.values.push_back(means[a].value);
    all.u_own.push_back(std::sqrt(own_variance(brdf, means[a])));
    for (std::size_t b = 0; b < means.size(); ++b) {
      all.covariance.push_back(shared_covariance(means[a], means[b]) + (a == b ? means[a].random_variance : 0.0));
    }
  }
  return all;
}

}  // namespace gonio::daemon
