#include "reflectance/sampling/any_incidence_sampler.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "reflectance/sampling/hemisphere_chart.h"
#include "reflectance/sampling/table_sampler.h"
#include "reflectance/surface/smooth_part.h"

namespace gonio::reflectance {
namespace {

constexpr double kLowest = 0.02;  // v of the lowest row: 0.02 deg of elevation

Error rows_refusal(std::string_view field, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "tabulate a surface for light from anywhere",
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{.file = {}, .field = std::string(field)}};
}

Direction turned_by(const Direction& d, Angle phi) {
  return Direction::from_cosine(d.mu(), d.sin_theta(), d.phi() + phi);
}

}  // namespace

struct AnyIncidenceSampler::Row {
  double v = 0.0;
  std::unique_ptr<const TableSampler> table;
};

Result<AnyIncidenceSampler> AnyIncidenceSampler::make(const Surface& surface, const RowOptions& options) {
  if (options.most_rows < 9 || options.most_rows > 513)
    return failure(rows_refusal("most_rows", fmt::format("{} rows", options.most_rows), "9 to 513"));
  if (!(options.most_ratio > 1.0))
    return failure(rows_refusal("most_ratio", fmt::format("ratio {}", options.most_ratio), "above 1"));
  if (!surface.is_isotropic())
    return failure(rows_refusal("surface", fmt::format("{} is anisotropic", surface.model()),
                                "isotropic, since rows are of theta_i alone; else make_sampler for each incidence"));
  AnyIncidenceSampler sampler(surface, options);
  constexpr int kFirstRows = 9;
  for (int k = 0; k < kFirstRows; ++k) GONIO_TRY(sampler.add_row(kLowest + (1.0 - kLowest) * k / (kFirstRows - 1)));
  GONIO_TRY(sampler.close_gaps());
  return sampler;
}

Result<void> AnyIncidenceSampler::add_row(double v) {
  constexpr SamplerOptions kCoarse{.use = TableUse::Fast, .accuracy = 0.02};
  auto table = TableSampler::make(SmoothPart{surface_}, chart_direction({.v = v, .w = 0.5}, {}), kCoarse);
  if (!table) return failure(std::move(table).error());
  const auto above = std::ranges::find_if(rows_, [&](const auto& row) { return row->v > v; });
  rows_.insert(above, std::make_shared<const Row>(Row{.v = v, .table = *std::move(table)}));
  return {};
}

Result<void> AnyIncidenceSampler::close_gaps() {
  for (std::size_t k = 0; k + 1 < rows_.size();) {
    const double middle = 0.5 * (rows_[k]->v + rows_[k + 1]->v);
    const double ratio = worst_ratio(middle);
    if (ratio <= options_.most_ratio) {
      met_ratio_ = std::max(met_ratio_, ratio);
      ++k;
      continue;
    }
    if (rows_.size() >= options_.most_rows) {
      return failure(rows_refusal(
          "most_rows",
          fmt::format("with {} rows weights reach {:.3g} times their mean at theta_i {:.2f} deg", rows_.size(), ratio,
                      in_degrees(chart_direction({.v = middle, .w = 0.5}, {}).theta())),
          fmt::format("{} times", options_.most_ratio)));
    }
    GONIO_TRY(add_row(middle));
  }
  return {};
}

double AnyIncidenceSampler::worst_ratio(double v) const {
  constexpr std::uint64_t kTried = 512;
  const Direction i = chart_direction({.v = v, .w = 0.5}, {});
  double sum = 0.0;
  double most = 0.0;
  for (std::uint64_t k = 0; k < kTried; ++k) {
    const double weight = sample(i, RandomStream(0), k).weight;
    sum += weight;
    most = std::max(most, weight);
  }
  return sum > 0.0 ? most * kTried / sum : 1.0;
}

AnyIncidenceSampler::Place AnyIncidenceSampler::place(double v) const {
  const auto above = std::upper_bound(rows_.begin() + 1, rows_.end() - 1, v,
                                      [](double level, const auto& row) { return level < row->v; });
  const auto low = static_cast<std::size_t>(above - rows_.begin()) - 1;
  const double width = rows_[low + 1]->v - rows_[low]->v;
  return {.low = low, .part = std::clamp((v - rows_[low]->v) / width, 0.0, 1.0)};
}

DirectionSample AnyIncidenceSampler::sample(const Direction& i, const RandomStream& stream, std::uint64_t index) const {
  const Place at = place(chart_point(i, i.phi()).v);
  const TableSampler& low = *rows_[at.low]->table;
  const TableSampler& high = *rows_[at.low + 1]->table;
  const UnitPoint choice = stream.point(index);

  const double mirror = surface_.specular(i);
  const double smooth = (1.0 - at.part) * low.report().rho_dh + at.part * high.report().rho_dh;
  const double all = mirror + smooth;
  if (!(all > 0.0)) return {};
  if (choice.u * all < mirror) return {.r = mirrored(i), .weight = all, .is_specular = true};

  const TableSampler& chosen = choice.v < at.part ? high : low;
  const Direction in_row = chosen.sample(stream.deeper(), index).r;
  const double density = (1.0 - at.part) * low.density_per_sr(in_row) + at.part * high.density_per_sr(in_row);
  const Direction r = turned_by(in_row, i.phi());
  const double wanted = in_per_steradian(surface_.eval(i, r)) * r.mu();
  return {.r = r, .weight = density > 0.0 ? wanted / density * (all / smooth) : 0.0};
}

}  // namespace gonio::reflectance
