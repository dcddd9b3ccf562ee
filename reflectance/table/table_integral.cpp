#include "reflectance/table/table_integral.h"

#include <array>
#include <cmath>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/refinement.h"

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

}  // namespace

Integral rho_dh(const TabulatedSurface& table, const Direction& i, double relative_tolerance) {
  if (table.options().reciprocal) return rho_dh(Surface(table), i, relative_tolerance);
  const IncidenceBracket bracket = table.bracket(i);
  bool has_cells = true;
  const Integral found = refined(0, static_cast<int>(kOrders.size()) - 1, relative_tolerance, [&](int level) {
    RuleSum sum;
    for (const IncidenceBracket::Share& share : bracket.shares()) {
      has_cells = has_cells && add_row(table, share, i, kOrders[static_cast<std::size_t>(level)], sum);
    }
    return sum;
  });
  return has_cells ? found : rho_dh(Surface(table), i, relative_tolerance);
}

}  // namespace gonio::reflectance
