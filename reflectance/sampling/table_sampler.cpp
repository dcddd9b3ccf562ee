#include "reflectance/sampling/table_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reflectance/integral/directional_reflectance.h"

namespace gonio::reflectance {
namespace {

Error table_refusal(std::string_view field, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "tabulate a surface to sample directions from",
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{.file = {}, .field = std::string(field)}};
}

Result<void> check_ranges(const SamplerOptions& options) {
  if (!(options.accuracy > 0.0))
    return failure(table_refusal("accuracy", fmt::format("accuracy {}", options.accuracy), "above 0"));
  constexpr std::size_t kLeast = 512;
  constexpr std::size_t kMost = std::size_t{1} << 22U;
  if (options.most_cells < kLeast || options.most_cells > kMost)
    return failure(table_refusal("most_cells", fmt::format("{} cells", options.most_cells), "512 to 2^22"));
  if (options.use == TableUse::Fast && options.negative_values == NegativeValues::Signed)
    return failure(table_refusal("negative_values", "signed weights in a fast table, whose weights are alike",
                                 "an unbiased table"));
  return {};
}

// |f| mu_r dOmega per square of the chart, and the first value that no density can have.
class ChartDensity {
 public:
  ChartDensity(const Surface& surface, const Direction& i, NegativeValues negative)
      : surface_(surface), i_(i), negative_(negative) {}

  void operator()(std::span<const ChartPoint> points, std::span<double> values) {
    directions_.clear();
    for (const ChartPoint& p : points) directions_.push_back(chart_direction(p, i_.phi()));
    brdf_.resize(points.size());
    surface_.eval(i_, directions_, brdf_);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double f = in_per_steradian(brdf_[k]);
      const bool is_wrong = !std::isfinite(f) || (f < 0.0 && negative_ == NegativeValues::Refuse);
      if (is_wrong && !wrong_) wrong_ = {directions_[k], f};
      values[k] = is_wrong ? 0.0 : std::abs(f) * directions_[k].mu() * chart_steradians(points[k].v);
    }
  }

  [[nodiscard]] Result<void> verdict() const {
    if (!wrong_) return {};
    const auto& [r, f] = *wrong_;
    return failure(table_refusal("surface",
                                 fmt::format("{} of {} sr^-1 at theta_r {} deg, phi_r {} deg", surface_.model(), f,
                                             in_degrees(r.theta()), in_degrees(r.phi())),
                                 negative_ == NegativeValues::Refuse ? "finite, at least 0" : "finite"));
  }

 private:
  const Surface& surface_;
  Direction i_;
  NegativeValues negative_;
  std::vector<Direction> directions_;
  std::vector<Brdf> brdf_;
  std::optional<std::pair<Direction, double>> wrong_;
};

// Four a cell, one a corner: the mass of the corner's own part of the bilinear density; then the mirror part.
std::vector<double> entry_masses(const DensityTree& tree, double specular) {
  std::vector<double> masses;
  for (const DensityCell& cell : tree.cells()) {
    for (const double corner : cell.corner) masses.push_back(0.25 * cell.dv * cell.dw * corner);
  }
  masses.push_back(specular);
  // A black surface has to be drawn from all the same, with weight 0.
  if (tree.mass() + specular == 0.0) std::ranges::fill(masses, 1.0);
  return masses;
}

}  // namespace

TableSampler::TableSampler(const Surface& surface, const Direction& i, DensityTree tree)
    : DirectionSampler(i),
      surface_(surface),
      tree_(std::move(tree)),
      alias_(entry_masses(tree_, surface.specular(i))),
      specular_(surface.specular(i)),
      total_(tree_.mass() + specular_) {}

Result<std::unique_ptr<const TableSampler>> TableSampler::make(const Surface& surface, const Direction& i,
                                                               const SamplerOptions& options) {
  GONIO_TRY(check_ranges(options));
  ChartDensity density(surface, i, options.negative_values);
  const Integral rho = rho_dh(surface, i, std::min(1e-3, 0.1 * options.accuracy));
  DensityTree::Goal goal{
      .accuracy = options.accuracy, .most_cells = options.most_cells, .has_peak = surface.feature() != Feature::Smooth};
  // The audit's points see more than those that steer: where they find too much, the goal is set higher.
  constexpr int kMostTrials = 4;
  for (int trial = 1;; ++trial) {
    DensityTree tree(std::ref(density), chart_point(i, i.phi()).v, goal);
    GONIO_TRY(density.verdict());
    std::unique_ptr<TableSampler> sampler(new TableSampler(surface, i, std::move(tree)));
    sampler->make_report(options, rho);
    const Result<void> verdict = sampler->check(options, rho);
    if (verdict) return sampler;
    if (trial == kMostTrials || sampler->report_.cells >= options.most_cells) return failure(verdict.error());
    goal.accuracy *= 0.25;
  }
}

void TableSampler::make_report(const SamplerOptions& options, const Integral& rho) {
  const DensityAudit& audit = tree_.audit();
  report_ = {.method = options.use == TableUse::Fast ? SamplingMethod::FastTable : SamplingMethod::Table,
             .rho_dh = rho.value,
             .rho_dh_error = rho.error,
             .most_weight = rho.value,
             .cells = tree_.cells().size(),
             .evaluations = tree_.evaluations() + rho.evaluations};
  if (total_ == 0.0) return;
  report_.relative_rms = std::sqrt(audit.relative_square / total_);
  if (options.use == TableUse::Fast) {
    // |a/A - b/B| <= |a - b|/A + b |1/A - 1/B|, summed over the hemisphere.
    report_.total_variation = 0.5 * (audit.absolute + std::abs(tree_.mass() - audit.integral)) / total_;
  } else {
    constexpr double kWidened = 2.0;
    report_.most_weight = total_ * (1.0 + kWidened * std::max(0.0, audit.most_ratio - 1.0));
  }
}

Result<void> TableSampler::check(const SamplerOptions& options, const Integral& rho) const {
  if (options.use == TableUse::Fast && report_.total_variation > options.accuracy) {
    return failure(table_refusal(
        "accuracy", fmt::format("{} cells misplace a share of {:.2g}", report_.cells, report_.total_variation),
        fmt::format("{:.2g} with at most {} cells", options.accuracy, options.most_cells)));
  }
  if (options.negative_values == NegativeValues::Signed) return {};  // the table is of |f|
  const double tabled = tree_.audit().integral + specular_;
  const double allowed = 2.0 * options.accuracy * rho.value + rho.error;
  if (std::abs(tabled - rho.value) <= allowed) return {};
  return failure(
      table_refusal("surface", fmt::format("the table holds {:.6g} of the light", tabled),
                    fmt::format("rho_dh {:.6g} +- {:.2g}: the cells have missed a peak", rho.value, allowed)));
}

double TableSampler::density_per_sr(const Direction& r) const {
  if (total_ == 0.0) return 0.0;
  const ChartPoint p = chart_point(r, incidence().phi());
  return tree_.at(p) / (chart_steradians(p.v) * total_);
}

void TableSampler::draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                            const SampleBatch& out) const {
  // The azimuth of the chart is turned so that 1/2 points towards i.
  const double cosine = -std::cos(incidence().phi().si());
  const double sine = -std::sin(incidence().phi().si());
  const bool is_weighted = report_.method == SamplingMethod::Table && total_ > 0.0;
  DrawBlock block;
  block.index.fill(0);
  for (std::size_t first = 0; first < indices.size(); first += DrawBlock::kSize) {
    const std::size_t count = std::min(DrawBlock::kSize, indices.size() - first);
    std::ranges::copy(indices.subspan(first, count), block.index.begin());
    fill_bits(stream, block);
    choose_places(block);
    fill_directions(cosine, sine, block);
    const SampleBatch part = out.part(first, count);
    std::copy_n(block.x.begin(), count, part.x.begin());
    std::copy_n(block.y.begin(), count, part.y.begin());
    std::copy_n(block.mu.begin(), count, part.z.begin());
    std::ranges::fill(part.weight, report_.rho_dh);
    std::ranges::fill(part.is_specular, std::uint8_t{0});
    if (is_weighted) weigh(block, part);
    if (specular_ > 0.0) put_mirrored(block, part);
  }
}

// The mirror part, the last entry, gets a place as well: it is overwritten.
const DensityCell& TableSampler::cell_of(std::uint32_t entry) const {
  return tree_.cells()[std::min<std::size_t>(entry / 4, tree_.cells().size() - 1)];
}

void TableSampler::choose_places(DrawBlock& block) const {
  for (std::size_t n = 0; n < DrawBlock::kSize; ++n) {
    const std::uint32_t entry = alias_.choose(block.bits[0][n], block.bits[1][n]);
    const DensityCell& cell = cell_of(entry);
    // From the corner that was chosen the density falls linearly: 1 - sqrt(u) from it.
    const double a = std::sqrt(open_unit(block.bits[2][n]));
    const double b = std::sqrt(open_unit(block.bits[3][n]));
    block.entry[n] = entry;
    block.v[n] = cell.v + cell.dv * ((entry & 1U) != 0 ? a : 1.0 - a);
    block.w[n] = cell.w + cell.dw * ((entry & 2U) != 0 ? b : 1.0 - b);
  }
}

void TableSampler::weigh(const DrawBlock& block, const SampleBatch& out) const {
  std::array<Direction, DrawBlock::kSize> directions;
  std::array<Brdf, DrawBlock::kSize> brdf;
  for (std::size_t n = 0; n < out.size(); ++n) {
    const Angle phi = incidence().phi() + radians(2.0 * std::numbers::pi * (block.w[n] - 0.5));
    directions[n] = Direction::from_cosine(block.mu[n], block.sin_theta[n], phi);
  }
  surface_.eval(incidence(), std::span(directions).first(out.size()), std::span(brdf).first(out.size()));
  for (std::size_t n = 0; n < out.size(); ++n) {
    const double wanted = in_per_steradian(brdf[n]) * block.mu[n] * chart_steradians(block.v[n]);
    out.weight[n] = total_ * wanted / cell_of(block.entry[n]).at({.v = block.v[n], .w = block.w[n]});
  }
}

void TableSampler::put_mirrored(const DrawBlock& block, const SampleBatch& out) const {
  const std::size_t entry = 4 * tree_.cells().size();
  const Vector r = mirrored(incidence()).vector();
  for (std::size_t n = 0; n < out.size(); ++n) {
    if (block.entry[n] != entry) continue;
    out.x[n] = r.x;
    out.y[n] = r.y;
    out.z[n] = r.z;
    out.weight[n] = report_.method == SamplingMethod::Table ? total_ : report_.rho_dh;
    out.is_specular[n] = 1;
  }
}

}  // namespace gonio::reflectance
