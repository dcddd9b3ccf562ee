#include "reflectance/table/tabulated_surface.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "reflectance/integral/hemisphere_integral.h"
#include "reflectance/table/detect_feature.h"
#include "reflectance/table/least_weight.h"

namespace gonio::reflectance {
namespace {

// By +phi for a row whose azimuths are phi_r itself.
Vector turned(const Vector& r, Angle phi) {
  const double c = std::cos(phi.si());
  const double s = std::sin(phi.si());
  return {.x = c * r.x - s * r.y, .y = s * r.x + c * r.y, .z = r.z};
}

IncidenceTilt tilt_of(const Direction& i) {
  return {.mu = i.mu(), .sin_theta = i.sin_theta()};
}

// The arcs of the profile made for the normal: as dense as the nodes are about the feature, the horizon at last.
std::vector<double> profile_arcs(const TableRow& row, Feature feature) {
  std::vector<double> arcs;
  for (const TableNode& node : row.nodes()) {
    const Vector r = moved(node.r, row.tilt(), {}, feature);
    arcs.push_back(std::atan2(std::hypot(r.x, r.y), r.z));
  }
  std::sort(arcs.begin(), arcs.end());
  constexpr std::size_t kMost = 256;
  const std::size_t step = arcs.size() / kMost + 1;
  std::vector<double> kept{0.0};
  for (std::size_t k = step / 2; k < arcs.size(); k += step) {
    if (arcs[k] - kept.back() > 1e-4) kept.push_back(arcs[k]);
  }
  return kept;
}

void add_origins(Origins& origins, const TableRow& row, const Vector& place, double weight) {
  const Stencil stencil = row.stencil(place);
  for (std::size_t k = 0; k < stencil.size; ++k) {
    for (const ReadingShare& share : row.origins(stencil.node[k])) {
      origins.push_back({.reading = share.reading, .weight = weight * stencil.weight[k] * share.weight});
    }
  }
}

// Each reading once.
Origins summed(Origins origins) {
  std::stable_sort(origins.begin(), origins.end(),
                   [](const ReadingShare& a, const ReadingShare& b) { return a.reading < b.reading; });
  Origins once;
  for (const ReadingShare& share : origins) {
    if (!once.empty() && once.back().reading == share.reading)
      once.back().weight += share.weight;
    else
      once.push_back(share);
  }
  return once;
}

// The surface at theta_i = 0, where no azimuth counts: what is left of a row when it is averaged over a turn, as it
// lies about each of its features. There the two are as close to any view.
TableRow normal_row(const TableRow& first, const TableOptions& options) {
  constexpr int kAzimuths = 72;
  std::vector<Feature> features{*options.feature};
  if (options.both_features) features = {Feature::HotSpot, Feature::Lobe};
  const double weight = 1.0 / (kAzimuths * static_cast<double>(features.size()));
  MergedNodes nodes;
  for (const double theta : profile_arcs(first, features.front())) {
    TableNode mean{.r = {.x = std::sin(theta), .y = 0.0, .z = std::cos(theta)}};
    Origins& origins = nodes.origins.emplace_back();
    for (int k = 0; k < kAzimuths; ++k) {
      const Vector r = turned(mean.r, radians(2.0 * std::numbers::pi * (k + 0.5) / kAzimuths));
      for (const Feature feature : features) {
        const Vector place = moved(r, {}, first.tilt(), feature);
        const TableRow::Value value = first.value_and_more(place);
        mean.f += weight * value.f;
        mean.u += weight * value.u;
        add_origins(origins, first, place, weight);
      }
    }
    nodes.nodes.push_back(mean);
    origins = summed(std::move(origins));
  }
  return TableRow::make(Angle{}, Angle{}, std::move(nodes), RowAzimuths::None, options).value();
}

// What was not declared is found.
TableOptions with_feature(TableOptions options, std::span<const TableRow> rows) {
  if (!options.feature) {
    const DetectedFeature found = detected_feature(rows);
    options.feature = found.feature;
    options.both_features = found.is_double;
  }
  options.both_features = options.both_features && options.feature != Feature::Smooth;
  return options;
}

bool is_normal(const TableRow& row, const TableOptions& options) {
  return row.theta_i() <= options.same_direction;
}

std::vector<RowIncidence> incidences(std::span<const TableRow> rows) {
  std::vector<RowIncidence> list;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    list.push_back({.theta_i = rows[k].theta_i(), .phi_i = rows[k].phi_i(), .row = k});
  }
  return list;
}

}  // namespace

TabulatedSurface::TabulatedSurface(std::vector<TableRow> rows, const TableOptions& options, TableReport report)
    : options_(with_feature(options, rows)),
      feature_(*options_.feature),
      rows_(std::make_shared<const std::vector<TableRow>>(std::move(rows))),
      report_(std::make_shared<const TableReport>(std::move(report))),
      index_(incidences(*rows_), options) {
  const auto first = std::min_element(rows_->begin(), rows_->end(),
                                      [](const TableRow& a, const TableRow& b) { return a.theta_i() < b.theta_i(); });
  if (options.symmetry == TableSymmetry::Anisotropic || is_normal(*first, options)) return;
  normal_row_ = std::make_shared<const TableRow>(normal_row(*first, options_));
  std::vector<RowIncidence> list = incidences(*rows_);
  list.push_back({.theta_i = {}, .phi_i = {}, .row = rows_->size()});
  index_ = IncidenceIndex(list, options);
}

Parameters TabulatedSurface::parameters() const {
  return {{"readings", static_cast<double>(report_->readings)},
          {"incidences", static_cast<double>(report_->incidences)}};
}

Vector TabulatedSurface::in_frame(const Direction& i, const Direction& r) const {
  const double turn = r.phi().si() - i.phi().si();
  const double y = r.sin_theta() * std::sin(turn);
  return {.x = r.sin_theta() * std::cos(turn), .y = is_isotropic() ? std::abs(y) : y, .z = r.mu()};
}

// Calls use(row, direction in the row's frame, weight) for all that the value under i is made of.
template <class Use>
void TabulatedSurface::at_places(const IncidenceBracket& bracket, const Direction& i, const Vector& seen,
                                 Use use) const {
  const IncidenceTilt tilt = tilt_of(i);
  const double retro = options_.both_features ? retro_share(seen, tilt) : 1.0;
  for (const IncidenceBracket::Share& share : bracket.shares()) {
    const TableRow& from = row(share.row);
    const auto place = [&](Feature feature) {
      const Vector p = moved(seen, tilt, from.tilt(), feature);
      return share.is_absolute ? turned(p, i.phi()) : p;
    };
    if (options_.both_features) {
      use(from, place(Feature::HotSpot), share.weight * retro);
      use(from, place(Feature::Lobe), share.weight * (1.0 - retro));
    } else {
      use(from, place(feature_), share.weight);
    }
  }
}

double TabulatedSurface::one_way(const Direction& i, const Direction& r) const {
  double f = 0.0;
  at_places(index_.bracket(i), i, in_frame(i, r),
            [&](const TableRow& from, const Vector& place, double weight) { f += weight * from.value(place); });
  return f;
}

TabulatedSurface::Known TabulatedSurface::known_one_way(const Direction& i, const Direction& r) const {
  const IncidenceBracket bracket = index_.bracket(i);
  Known known{.is_covered = bracket.is_covered, .distance = bracket.distance};
  at_places(bracket, i, in_frame(i, r), [&](const TableRow& from, const Vector& place, double weight) {
    const TableRow::Value value = from.value_and_more(place);
    known.f += weight * value.f;
    known.u += weight * value.u;
    known.distance += weight * value.distance;
    known.is_covered = known.is_covered && (value.is_covered || weight < kLeastWeight);
  });
  return known;
}

void TabulatedSurface::visit_rows(const Direction& i, const Direction& r, const RowVisitor& visit) const {
  at_places(index_.bracket(i), i, in_frame(i, r), [&](const TableRow& from, const Vector& place, double weight) {
    visit(from, from.stencil(place), weight);
  });
}

std::optional<double> TabulatedSurface::told_by_other_incidences(const TableRow& own, const Vector& view) const {
  std::vector<RowIncidence> others = incidences(*rows_);
  std::erase_if(others, [&](const RowIncidence& other) { return &(*rows_)[other.row] == &own; });
  if (others.empty() || others.size() == rows_->size()) return std::nullopt;
  const Direction i = Direction::from_angles(own.theta_i(), own.phi_i());
  const IncidenceBracket bracket = IncidenceIndex(others, options_).bracket(i);
  if (!bracket.is_covered) return std::nullopt;
  double f = 0.0;
  at_places(bracket, i, view,
            [&](const TableRow& from, const Vector& place, double weight) { f += weight * from.value(place); });
  return f;
}

bool TabulatedSurface::shares(const Direction& i, const Direction& r, std::vector<ReadingShare>& shares) const {
  assert(options_.beyond == BeyondReach::Hold);
  const IncidenceBracket bracket = index_.bracket(i);
  bool is_covered = bracket.is_covered;
  at_places(bracket, i, in_frame(i, r), [&](const TableRow& from, const Vector& place, double weight) {
    const Stencil stencil = from.stencil(place);
    is_covered = is_covered && (weight < kLeastWeight || from.is_covered(stencil));
    for (std::size_t k = 0; k < stencil.size; ++k) {
      for (const ReadingShare& share : from.origins(stencil.node[k])) {
        shares.push_back({.reading = share.reading, .weight = weight * stencil.weight[k] * share.weight});
      }
    }
  });
  return is_covered;
}

// Weights fall with the square of the distance from readings, down to a tenth of a degree: a reading prevails over what
// is interpolated for its partner. Sums and products are symmetric, so (i, r) and (r, i) give the same bits.
TabulatedSurface::Known TabulatedSurface::both_ways(const Direction& i, const Direction& r) const {
  const Known a = known_one_way(i, r);
  const Known b = known_one_way(r, i);
  constexpr double kClose = 0.1 * std::numbers::pi / 180.0;
  const double weight_a = 1.0 / (a.distance * a.distance + kClose * kClose);
  const double weight_b = 1.0 / (b.distance * b.distance + kClose * kClose);
  const double total = weight_a + weight_b;
  return {.f = (weight_a * a.f + weight_b * b.f) / total,
          .u = (weight_a * a.u + weight_b * b.u) / total,
          .is_covered = a.is_covered || b.is_covered,
          .distance = std::min(a.distance, b.distance)};
}

Measured<Brdf> TabulatedSurface::measured(const Direction& i, const Direction& r) const {
  const Known known = options_.reciprocal ? both_ways(i, r) : known_one_way(i, r);
  return {.value = per_steradian(known.f), .u = per_steradian(known.u)};
}

bool TabulatedSurface::covers(const Direction& i, const Direction& r) const {
  return options_.reciprocal ? both_ways(i, r).is_covered : known_one_way(i, r).is_covered;
}

double TabulatedSurface::extrapolated_share(const Direction& i) const {
  constexpr int kRings = 64;
  double share = 0.0;
  for (const HemisphereNode& node : gauss_rings(kRings, 2 * kRings)) {
    if (!covers(i, node.direction)) share += node.weight_sr / std::numbers::pi;
  }
  return share;
}

TabulatedSurface TabulatedSurface::without_incidence(std::size_t k) const {
  std::vector<TableRow> rows = *rows_;
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(k));
  return {std::move(rows), options_, *report_};
}

}  // namespace gonio::reflectance
