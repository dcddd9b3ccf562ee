#include "reflectance/table/interpolation_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "reflectance/table/least_weight.h"

namespace gonio::reflectance {
namespace {

// The error of a weighted mean of values, each of which is off what the others make of it by e.
class CellError {
 public:
  void add(double weight, double e) {
    const double part = 0.5 * weight * (1.0 - weight);
    sum_ += part;
    squares_ += part * e * e;
  }
  // The root mean square of e, times the sum of the parts.
  [[nodiscard]] double value() const { return std::sqrt(std::max(0.0, sum_ * squares_)); }

 private:
  double sum_ = 0.0;
  double squares_ = 0.0;
};

class ValueRange {
 public:
  void add(double f) {
    least_ = is_empty_ ? f : std::min(least_, f);
    most_ = is_empty_ ? f : std::max(most_, f);
    is_empty_ = false;
  }
  [[nodiscard]] double width() const { return most_ - least_; }

 private:
  bool is_empty_ = true;
  double least_ = 0.0;
  double most_ = 0.0;
};

// Of the values at a stencil's nodes: all of them, or those on the ring of one.
double range_of(const TableRow& row, const Stencil& stencil, std::optional<std::size_t> on_ring_of = std::nullopt) {
  constexpr double kSameRing = 1e-6;  // of cosines
  ValueRange range;
  for (std::size_t k = 0; k < stencil.size; ++k) {
    const TableNode& node = row.node(stencil.node[k]);
    if (stencil.weight[k] > 0.0 && (!on_ring_of || std::abs(node.r.z - row.node(*on_ring_of).r.z) < kSameRing))
      range.add(node.f);
  }
  return range.width();
}

// Of a node on rings. Where its neighbours do not lie along its ring, what is missing is how the value changes there.
double error_on_rings(const TableRow& row, const Stencil& stencil, std::size_t node) {
  const std::optional<std::size_t> measured = row.measured_node(node);
  const std::vector<double> told = measured ? row.without(*measured) : std::vector<double>();
  if (told.empty()) return range_of(row, stencil);
  double e = told.size() < row.neighbourhoods() ? range_of(row, stencil, node) : 0.0;
  for (const double other : told) e = std::max(e, std::abs(other - row.node(node).f));
  return e;
}

double between_views(const TableRow& row, const Stencil& stencil) {
  CellError error;
  const std::optional<std::vector<double>> bends = row.bends(stencil.place);
  double of_cell = 0.0;
  if (bends) {
    constexpr std::size_t kFewest = 2;  // one side alone says nothing of the other direction
    if (bends->size() < kFewest) of_cell = range_of(row, stencil);
    for (const double bend : *bends) of_cell = std::max(of_cell, std::abs(bend));
  }
  for (std::size_t k = 0; k < stencil.size; ++k)
    error.add(stencil.weight[k], bends ? of_cell : error_on_rings(row, stencil, stencil.node[k]));
  return error.value();
}

// Of an incidence that was made for the normal from the first one: nothing for a measured one.
double of_made_incidence(const TabulatedSurface& table, const TableRow& row, const Vector& view) {
  const std::span<const TableRow> rows = table.rows();
  if (std::ranges::any_of(rows, [&](const TableRow& own) { return &own == &row; })) return 0.0;
  const TableRow& first = *std::ranges::min_element(rows, {}, [](const TableRow& own) { return own.theta_i(); });
  return std::abs(row.value(view) - first.value(view));
}

// One incidence's part of a value.
struct RowPart {
  const TableRow* row = nullptr;
  double weight = 0.0;
  double f = 0.0;                 // times the weight
  double square = 0.0;            // of e, times the weight
  bool is_told_by_others = true;  // else e is not known
};

RowPart& part_of(std::vector<RowPart>& parts, const TableRow& row) {
  const auto known = std::ranges::find(parts, &row, &RowPart::row);
  return known != parts.end() ? *known : parts.emplace_back(RowPart{.row = &row});
}

double between_incidences(const std::vector<RowPart>& parts) {
  ValueRange range;
  for (const RowPart& part : parts) range.add(part.f / part.weight);
  CellError error;
  for (const RowPart& part : parts) {
    error.add(part.weight, part.is_told_by_others ? std::sqrt(part.square / part.weight) : range.width());
  }
  return error.value();
}

}  // namespace

TablePlace place_in(const TabulatedSurface& table, const Direction& i, const Direction& r) {
  if (!table.bracket(i).is_covered) return TablePlace::BeyondIncidences;
  bool is_beyond = false;
  bool is_in_hole = false;
  table.visit_rows(i, r, [&](const TableRow& row, const Stencil& stencil, double weight) {
    if (weight < kLeastWeight || row.is_covered(stencil)) return;
    is_beyond = is_beyond || !stencil.is_inside;
    is_in_hole = true;
  });
  if (is_beyond) return TablePlace::BeyondViews;
  return is_in_hole ? TablePlace::InAHole : TablePlace::Within;
}

Brdf interpolation_uncertainty(const TabulatedSurface& table, const Direction& i, const Direction& r) {
  std::vector<RowPart> parts;
  double views = 0.0;
  table.visit_rows(i, r, [&](const TableRow& row, const Stencil& stencil, double weight) {
    if (weight <= 0.0) return;
    views += weight * (between_views(row, stencil) + of_made_incidence(table, row, stencil.place));
    const double f = row.value(stencil.place);
    const std::optional<double> others = table.told_by_other_incidences(row, stencil.place);
    const double e = others ? *others - f : 0.0;
    RowPart& part = part_of(parts, row);
    part.weight += weight;
    part.f += weight * f;
    part.square += weight * e * e;
    part.is_told_by_others = part.is_told_by_others && others.has_value();
  });
  return per_steradian(std::hypot(views, between_incidences(parts)));
}

}  // namespace gonio::reflectance
