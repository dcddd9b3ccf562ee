#include "reflectance/sampling/literal_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "reflectance/integral/directional_reflectance.h"

namespace gonio::reflectance {
namespace {

Result<void> check_cells(std::string_view name, int count) {
  if (count >= 1 && count <= 4096) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "sample by the equations of appendix C",
                  .seen = fmt::format("{} cells in {}", count, name),
                  .limit = "1 to 4096",
                  .where = InputLocation{.file = {}, .field = std::string(name)}});
}

struct Found {
  std::size_t cell;
  double part;  // of the cell, below the place
};

// The place at which an ascending distribution, 0 at first, reaches `level`.
Found place_of_level(const std::vector<double>& below, double level) {
  const auto above = std::upper_bound(below.begin() + 1, below.end() - 1, level);
  const auto cell = static_cast<std::size_t>(above - below.begin()) - 1;
  const double width = below[cell + 1] - below[cell];
  return {.cell = cell, .part = width > 0.0 ? std::clamp((level - below[cell]) / width, 0.0, 1.0) : 0.5};
}

}  // namespace

LiteralSampler::LiteralSampler(const Surface& surface, LiteralCells cells) : surface_(surface), cells_(cells) {
  const double step = 0.5 * std::numbers::pi / cells.theta;
  for (int k = 0; k < cells.theta; ++k) theta_.push_back(radians((k + 0.5) * step));
  for (int k = 0; k <= cells.theta; ++k) sin2_edges_.push_back(0.5 - 0.5 * std::cos(2.0 * k * step));
}

Result<LiteralSampler> LiteralSampler::make(const Surface& surface, LiteralCells cells) {
  GONIO_TRY(check_cells("theta", cells.theta));
  GONIO_TRY(check_cells("phi", cells.phi));
  return LiteralSampler(surface, cells);
}

// The integral of f cos(theta) sin(theta) dtheta up to each edge, at one phi.
double LiteralSampler::column(const Direction& i, Angle phi, std::vector<double>& below) const {
  below.assign(1, 0.0);
  for (std::size_t k = 0; k < theta_.size(); ++k) {
    const double f = in_per_steradian(surface_.eval(i, Direction::from_angles(theta_[k], phi)));
    below.push_back(below.back() + 0.5 * f * (sin2_edges_[k + 1] - sin2_edges_[k]));
  }
  return below.back();
}

LiteralSampler::Incidence LiteralSampler::incidence(const Direction& i) const {
  Incidence result{.i = i, .share_below = {0.0}, .specular = surface_.specular(i)};
  const double step = 2.0 * std::numbers::pi / cells_.phi;
  std::vector<double> below;
  for (int j = 0; j < cells_.phi; ++j) {
    const double light = step * column(i, radians((j + 0.5) * step), below);
    result.share_below.push_back(result.share_below.back() + light);
  }
  result.rho_dh = result.share_below.back() + result.specular;
  return result;
}

DirectionSample LiteralSampler::sample(const Incidence& incidence, UnitPoint draw) const {
  if (!(incidence.rho_dh > 0.0)) return {};
  const double level = draw.u * incidence.rho_dh - incidence.specular;
  if (level < 0.0) return {.r = mirrored(incidence.i), .weight = incidence.rho_dh, .is_specular = true};
  const double step = 2.0 * std::numbers::pi / cells_.phi;
  const Found in_phi = place_of_level(incidence.share_below, level);
  const Angle phi = radians((static_cast<double>(in_phi.cell) + in_phi.part) * step);

  std::vector<double> below;
  const double light = column(incidence.i, phi, below);
  const Found in_theta = place_of_level(below, draw.v * light);
  const double low = sin2_edges_[in_theta.cell];
  const double sin2 = low + in_theta.part * (sin2_edges_[in_theta.cell + 1] - low);
  return {.r = Direction::from_cosine(std::sqrt(std::max(0.0, 1.0 - sin2)), std::sqrt(sin2), phi),
          .weight = incidence.rho_dh};
}

double LiteralSampler::rho_dh_error(const Direction& i) const {
  return std::abs(incidence(i).rho_dh / gonio::reflectance::rho_dh(surface_, i).value - 1.0);
}

}  // namespace gonio::reflectance
