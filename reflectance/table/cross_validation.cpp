#include "reflectance/table/cross_validation.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gonio::reflectance {
namespace {

struct Pair {
  Direction i;
  Direction r;
};

Pair pair_of(const TableRow& row, const TableNode& node, const TableOptions& options) {
  const bool is_absolute = options.symmetry == TableSymmetry::Anisotropic && row.theta_i() <= options.same_direction;
  const Direction i = Direction::from_angles(row.theta_i(), row.phi_i());
  const Direction r = Direction::from_vector(node.r);
  return {.i = i, .r = is_absolute ? r : Direction::from_cosine(r.mu(), r.sin_theta(), r.phi() + i.phi())};
}

class Tally {
 public:
  void add(const Pair& pair, double f, double told) {
    const double off = std::abs(told - f);
    if (off > most_) {
      most_ = off;
      result_.worst = geometry_of(pair.i, pair.r);
    }
    squares_ += off * off;
    sizes_ += std::abs(f);
    ++result_.count;
  }

  [[nodiscard]] CrossValidation result() const {
    CrossValidation result = result_;
    if (result.count == 0) return result;
    const auto count = static_cast<double>(result.count);
    result.rms = per_steradian(std::sqrt(squares_ / count));
    result.most = per_steradian(most_);
    result.mean = per_steradian(sizes_ / count);
    return result;
  }

 private:
  CrossValidation result_;
  double squares_ = 0.0;
  double sizes_ = 0.0;
  double most_ = 0.0;
};

bool is_outermost(const TabulatedSurface& table, const TableRow& row) {
  const auto [first, last] =
      std::minmax_element(table.rows().begin(), table.rows().end(),
                          [](const TableRow& a, const TableRow& b) { return a.theta_i() < b.theta_i(); });
  const Angle tolerance = table.options().same_direction;
  return row.theta_i() <= first->theta_i() + tolerance || row.theta_i() + tolerance >= last->theta_i();
}

}  // namespace

void visit_view_errors(const TabulatedSurface& table, const ValidationVisitor& visit) {
  for (const TableRow& row : table.rows()) {
    for (std::size_t k = 0; k < row.nodes().size(); ++k) {
      const std::vector<double> told = row.without(k);
      if (told.empty()) continue;
      const double f = row.nodes()[k].f;
      const double worse = *std::max_element(told.begin(), told.end(),
                                             [&](double a, double b) { return std::abs(a - f) < std::abs(b - f); });
      const Pair pair = pair_of(row, row.nodes()[k], table.options());
      visit(pair.i, pair.r, f, worse);
    }
  }
}

void visit_incidence_errors(const TabulatedSurface& table, const ValidationVisitor& visit) {
  for (std::size_t k = 0; k < table.rows().size(); ++k) {
    const TableRow& row = table.rows()[k];
    if (is_outermost(table, row)) continue;
    const TabulatedSurface rest = table.without_incidence(k);
    for (const TableNode& node : row.nodes()) {
      const Pair pair = pair_of(row, node, table.options());
      visit(pair.i, pair.r, node.f, rest.known_one_way(pair.i, pair.r).f);
    }
  }
}

CrossValidation cross_validate_views(const TabulatedSurface& table) {
  Tally tally;
  visit_view_errors(table, [&](const Direction& i, const Direction& r, double f, double told) {
    tally.add({.i = i, .r = r}, f, told);
  });
  return tally.result();
}

CrossValidation cross_validate_incidences(const TabulatedSurface& table) {
  Tally tally;
  visit_incidence_errors(table, [&](const Direction& i, const Direction& r, double f, double told) {
    tally.add({.i = i, .r = r}, f, told);
  });
  return tally.result();
}

CrossValidation compare_both_ways(const TabulatedSurface& table) {
  Tally tally;
  for (const TableRow& row : table.rows()) {
    for (const TableNode& node : row.nodes()) {
      const Pair pair = pair_of(row, node, table.options());
      const TabulatedSurface::Known here = table.known_one_way(pair.i, pair.r);
      const TabulatedSurface::Known there = table.known_one_way(pair.r, pair.i);
      if (here.is_covered && there.is_covered) tally.add(pair, here.f, there.f);
    }
  }
  return tally.result();
}

}  // namespace gonio::reflectance
