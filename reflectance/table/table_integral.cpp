// rho_dh of a table: by Gauss nodes within the cells of its readings, so that no kink lies inside of a panel.
#include <algorithm>
#include <array>
#include <cmath>

#include "reflectance/integral/hemisphere_integral.h"
#include "reflectance/integral/refinement.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {
namespace {

// Gauss orders, raised one by one.
constexpr std::array kOrders{2, 3, 5, 8};

// The share of one measured incidence: over its own cells, each node carried to where the incidence i sees it, with
// each feature that moves.
[[nodiscard]] bool add_row(const TabulatedSurface& table, const IncidenceBracket::Share& share, const Direction& i,
                           int order, RuleSum& sum) {
  const TableRow& row = table.row(share.row);
  const IncidenceTilt tilt{.mu = i.mu(), .sin_theta = i.sin_theta()};
  const bool is_double = table.options().both_features;
  const double c = std::cos(i.phi().si());
  const double s = std::sin(i.phi().si());
  return row.quadrature(order, [&](const Vector& place, double solid_angle) {
    const Vector seen =
        share.is_absolute ? Vector{c * place.x + s * place.y, c * place.y - s * place.x, place.z} : place;
    const double term = share.weight * row.value(place) * solid_angle;
    double stretch = 1.0;
    const Vector r = moved(seen, row.tilt(), tilt, is_double ? Feature::HotSpot : table.feature(), &stretch);
    sum.add(term * r.z * stretch * (is_double ? retro_share(r, tilt) : 1.0));
    if (!is_double) return;
    const Vector other = moved(seen, row.tilt(), tilt, Feature::Lobe, &stretch);
    sum.add(term * other.z * stretch * (1.0 - retro_share(other, tilt)));
  });
}

// Rings take kinks as they come, and err by the square of their spacing: two levels may agree by chance, so that the
// step before, shrunk by as much, counts as well, and both thrice.
Integral over_rings(const TabulatedSurface& table, const Direction& i, double relative_tolerance) {
  constexpr int kFirstRings = 16;
  constexpr int kMostRings = 256;
  Integral result;
  double last_step = 0.0;
  for (int rings = kFirstRings; rings <= kMostRings; rings *= 2) {
    RuleSum sum;
    for (const HemisphereNode& node : gauss_rings(rings, 2 * rings, RingSpacing::SqrtMu)) {
      sum.add(node.weight_sr * in_per_steradian(table.eval(i, node.direction)));
    }
    const double step = std::abs(sum.value() - result.value);
    result.value = sum.value();
    result.error = 3.0 * std::max(step, 0.25 * last_step) + kRuleRounding * sum.size();
    result.evaluations += sum.evaluations();
    if (rings > 2 * kFirstRings && result.error <= relative_tolerance * sum.size()) break;
    last_step = step;
  }
  return result;
}

}  // namespace

Integral TabulatedSurface::rho_dh(const Direction& i, double relative_tolerance) const {
  if (options_.reciprocal) return over_rings(*this, i, relative_tolerance);
  const IncidenceBracket shares = bracket(i);
  bool has_cells = true;
  const Integral found = refined(0, static_cast<int>(kOrders.size()) - 1, relative_tolerance, [&](int level) {
    RuleSum sum;
    for (const IncidenceBracket::Share& share : shares.shares()) {
      has_cells = has_cells && add_row(*this, share, i, kOrders[static_cast<std::size_t>(level)], sum);
    }
    return sum;
  });
  return has_cells ? found : over_rings(*this, i, relative_tolerance);
}

}  // namespace gonio::reflectance
