#include "reflectance/table/incidence_index.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reflectance/table/least_weight.h"

namespace gonio::reflectance {

IncidenceIndex::IncidenceIndex(std::span<const RowIncidence> rows, const TableOptions& options)
    : tolerance_(options.same_direction.si()),
      widest_step_(options.widest_incidence_step.si()),
      is_anisotropic_(options.symmetry == TableSymmetry::Anisotropic) {
  std::vector<RowIncidence> sorted(rows.begin(), rows.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const RowIncidence& a, const RowIncidence& b) { return a.theta_i < b.theta_i; });
  for (const RowIncidence& row : sorted) {
    if (rings_.empty() || row.theta_i.si() - rings_.back().theta > tolerance_) {
      rings_.push_back({.theta = row.theta_i.si(), .rows = {}});
    }
    rings_.back().rows.push_back(row);
  }
  for (Ring& ring : rings_) {
    std::sort(ring.rows.begin(), ring.rows.end(),
              [](const RowIncidence& a, const RowIncidence& b) { return a.phi_i < b.phi_i; });
  }
}

void IncidenceIndex::add(IncidenceBracket& bracket, const Ring& ring, const Direction& i, double weight) const {
  if (weight <= 0.0) return;
  const bool counts = weight >= kLeastWeight;
  const bool is_pole = is_anisotropic_ && ring.theta <= tolerance_;
  const double off_theta = std::abs(i.theta().si() - ring.theta);
  if (ring.rows.size() == 1) {
    bracket.add({.row = ring.rows[0].row, .weight = weight, .is_absolute = is_pole});
    double off_phi = 0.0;
    if (is_anisotropic_ && !is_pole) {
      off_phi = i.sin_theta() * std::abs(wrapped(i.phi() - ring.rows[0].phi_i).si());
      bracket.is_covered = bracket.is_covered && (!counts || off_phi <= tolerance_);
    }
    bracket.distance += weight * (off_theta + off_phi);
    return;
  }
  const auto above = std::upper_bound(ring.rows.begin(), ring.rows.end(), i.phi(),
                                      [](Angle phi, const RowIncidence& row) { return phi < row.phi_i; });
  const RowIncidence& b = above == ring.rows.end() ? ring.rows.front() : *above;
  const RowIncidence& a = above == ring.rows.begin() ? ring.rows.back() : *(above - 1);
  const auto turn = [](Angle from, Angle to) {
    const double d = to.si() - from.si();
    return d < 0.0 ? d + 2.0 * std::numbers::pi : d;
  };
  const double gap = turn(a.phi_i, b.phi_i);
  const double past = turn(a.phi_i, i.phi());
  const double share = past / gap;
  bracket.add({.row = a.row, .weight = weight * (1.0 - share)});
  if (share > 0.0) bracket.add({.row = b.row, .weight = weight * share});
  const double off_phi = std::min(past, gap - past) * std::sin(ring.theta);
  const bool is_near = off_phi <= tolerance_ || gap * std::sin(ring.theta) <= widest_step_;
  bracket.is_covered = bracket.is_covered && (!counts || is_near);
  bracket.distance += weight * (off_theta + i.sin_theta() * ((1.0 - share) * past + share * (gap - past)));
}

IncidenceBracket IncidenceIndex::bracket(const Direction& i) const {
  const double theta = i.theta().si();
  const auto above =
      std::upper_bound(rings_.begin(), rings_.end(), theta, [](double t, const Ring& g) { return t < g.theta; });
  IncidenceBracket bracket;
  if (above == rings_.begin() || above == rings_.end()) {
    const Ring& ring = above == rings_.begin() ? rings_.front() : rings_.back();
    bracket.is_covered = std::abs(theta - ring.theta) <= tolerance_;
    add(bracket, ring, i, 1.0);
    return bracket;
  }
  const Ring& below = *(above - 1);
  const double step = above->theta - below.theta;
  const double share = (theta - below.theta) / step;
  bracket.is_covered = step <= widest_step_ || theta - below.theta <= tolerance_ || above->theta - theta <= tolerance_;
  add(bracket, below, i, 1.0 - share);
  add(bracket, *above, i, share);
  return bracket;
}

}  // namespace gonio::reflectance
