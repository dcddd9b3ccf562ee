#include "daemon/analysis/drawn_surfaces.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "reflectance/table/tabulated_surface.h"

namespace gonio::analysis {
namespace {

using reflectance::Direction;
using reflectance::TableRow;
using reflectance::TabulatedSurface;

// The widths [rad] of the cells under evenly spread views, each as often as it is met.
void add_widths(const TableRow& row, std::vector<double>& widths) {
  constexpr double kSinStep = 0.02;
  constexpr double kPhiStepDeg = 5.0;
  for (double sin_theta = 0.5 * kSinStep; sin_theta < 1.0; sin_theta += kSinStep) {
    const double mu = std::sqrt(1.0 - sin_theta * sin_theta);
    for (double phi = 0.0; phi < 360.0; phi += kPhiStepDeg) {
      const Direction r = Direction::from_cosine(mu, sin_theta, degrees(phi));
      const reflectance::Stencil stencil = row.stencil(r.vector());
      if (stencil.is_inside) widths.push_back(stencil.width);
    }
  }
}

// Half as wide again as most of the cells are: on rings of few azimuths the outer ones are the widest.
Angle widest_usual_cell(const formats::SurfaceFile& surfaces) {
  constexpr double kMost = 0.75;
  constexpr double kMargin = 1.5;
  constexpr Angle kWidest = degrees(90.0);
  std::vector<double> widths;
  for (const formats::ChannelSurface& channel : surfaces.channels) {
    const auto* table = channel.surface.as<TabulatedSurface>();
    if (table == nullptr || table->options().layout == reflectance::TableLayout::Rings) continue;  // all in one plane
    for (const TableRow& row : table->rows()) add_widths(row, widths);
  }
  if (widths.empty()) return Angle{};
  const auto usual = widths.begin() + static_cast<std::ptrdiff_t>(kMost * static_cast<double>(widths.size() - 1));
  std::nth_element(widths.begin(), usual, widths.end());
  return std::min(kMargin * radians(*usual), kWidest);
}

}  // namespace

Result<formats::SurfaceFile> drawn_surfaces(const formats::MeasuredBrdf& brdf) {
  const reflectance::TableOptions usual;
  Result<formats::SurfaceFile> surfaces = formats::surfaces_of(brdf);
  if (!surfaces) return surfaces;
  const Angle widest = widest_usual_cell(*surfaces);
  if (widest <= usual.widest_cell) return surfaces;
  return formats::surfaces_of(brdf, {.widest_cell = widest});
}

}  // namespace gonio::analysis
