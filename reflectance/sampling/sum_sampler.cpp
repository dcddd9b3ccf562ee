#include "reflectance/sampling/sum_sampler.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace gonio::reflectance {
namespace {

std::vector<double> shares_of_light(const std::vector<SumSampler::Term>& terms) {
  assert(!terms.empty());
  std::vector<double> light;
  for (const SumSampler::Term& term : terms) {
    const SamplerReport& part = term.sampler->report();
    // A term whose signed values cancel, or more than that, is drawn by its size.
    light.push_back(term.weight * (part.rho_dh > 0.0 ? part.rho_dh : part.most_weight));
  }
  const double sum = std::accumulate(light.begin(), light.end(), 0.0);
  // A black sum has to be drawn from all the same, with weight 0.
  if (sum == 0.0) return std::vector<double>(light.size(), 1.0 / static_cast<double>(light.size()));
  for (double& share : light) share /= sum;
  return light;
}

}  // namespace

SumSampler::SumSampler(std::vector<Term> terms)
    : DirectionSampler(terms.at(0).sampler->incidence()), terms_(std::move(terms)), alias_(shares_of_light(terms_)) {
  const std::vector<double> probability = shares_of_light(terms_);
  report_ = {.method = SamplingMethod::Sum};
  double relative_square = 0.0;
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    assert(terms_[k].sampler->incidence() == incidence());
    const SamplerReport& part = terms_[k].sampler->report();
    const double scale = probability[k] > 0.0 ? terms_[k].weight / probability[k] : 0.0;
    scales_.push_back(scale);
    report_.rho_dh += terms_[k].weight * part.rho_dh;
    report_.rho_dh_error += terms_[k].weight * part.rho_dh_error;
    report_.most_weight = std::max(report_.most_weight, scale * part.most_weight);
    report_.total_variation += probability[k] * part.total_variation;
    relative_square += probability[k] * part.relative_rms * part.relative_rms;
    report_.cells += part.cells;
    report_.evaluations += part.evaluations;
  }
  report_.relative_rms = std::sqrt(relative_square);
}

void SumSampler::draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                          const SampleBatch& out) const {
  std::array<std::uint32_t, kRun> chosen;
  for (std::size_t n = 0; n < indices.size(); ++n) {
    const RandomBlock bits = stream.block(indices[n]);
    chosen[n] = alias_.choose(bits[0], bits[1]);
  }
  for (std::size_t term = 0; term < terms_.size(); ++term)
    draw_term(term, stream.deeper(), indices, std::span(chosen).first(indices.size()), out);
}

void SumSampler::draw_term(std::size_t term, const RandomStream& stream, std::span<const std::uint64_t> indices,
                           std::span<const std::uint32_t> chosen, const SampleBatch& out) const {
  std::array<std::uint64_t, kRun> own;
  std::array<std::size_t, kRun> place;
  std::size_t count = 0;
  for (std::size_t n = 0; n < indices.size(); ++n) {
    if (chosen[n] != term) continue;
    own[count] = indices[n];
    place[count++] = n;
  }
  std::array<double, kRun> x;
  std::array<double, kRun> y;
  std::array<double, kRun> z;
  std::array<double, kRun> weight;
  std::array<std::uint8_t, kRun> is_specular;
  const SampleBatch drawn = SampleBatch{x, y, z, weight, is_specular}.part(0, count);
  terms_[term].sampler->draw(stream, std::span(own).first(count), drawn);
  for (std::size_t k = 0; k < count; ++k) {
    out.x[place[k]] = x[k];
    out.y[place[k]] = y[k];
    out.z[place[k]] = z[k];
    out.weight[place[k]] = scales_[term] * weight[k];
    out.is_specular[place[k]] = is_specular[k];
  }
}

}  // namespace gonio::reflectance
