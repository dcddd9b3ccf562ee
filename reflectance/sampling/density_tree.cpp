#include "reflectance/sampling/density_tree.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "reflectance/integral/gauss_legendre.h"

namespace gonio::reflectance {
namespace {

constexpr std::size_t kColumns = 8;       // of cells around the hemisphere, before any is halved
constexpr std::size_t kLeastCells = 512;  // so that a feature as wide as a twentieth of the hemisphere is met
constexpr double kLeastWidth = 0x1p-40;   // of a cell: beyond it its corners lose their digits
constexpr double kSliver = 1e-4;          // of a row of roots
constexpr double kPeakWidth = 0x1p-17;    // of the cells that touch a possible peak: 1e-5 rad
// Where density / tree is more, a cell is halved if its share counts, and else made an envelope.
constexpr double kSteep = 1.3;

using UnitPlace = std::array<double, 2>;

ChartPoint place(const DensityCell& cell, UnitPlace p) {
  return {.v = cell.v + cell.dv * p[0], .w = cell.w + cell.dw * p[1]};
}

std::array<UnitPlace, 4> corners() {
  return {{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}}};
}

struct WeightedPlace {
  UnitPlace place;
  double weight;
};

std::vector<WeightedPlace> gauss_places(int size) {
  const UnitRule rule = gauss_legendre(size);
  std::vector<WeightedPlace> places;
  for (std::size_t b = 0; b < rule.nodes.size(); ++b) {
    for (std::size_t a = 0; a < rule.nodes.size(); ++a)
      places.push_back({{rule.nodes[a], rule.nodes[b]}, rule.weights[a] * rule.weights[b]});
  }
  return places;
}

// Gauss points, then the rim, which weighs nothing: there the ratio is often worst.
std::vector<WeightedPlace> audit_places() {
  std::vector<WeightedPlace> places = gauss_places(4);
  constexpr double kInset = 1e-3;
  constexpr std::array kRim{kInset, 0.5, 1.0 - kInset};
  for (const double b : kRim) {
    for (const double a : kRim) {
      if (a != 0.5 || b != 0.5) places.push_back({{a, b}, 0.0});
    }
  }
  return places;
}

}  // namespace

// Halves the cell that is off most, again and again.
class DensityTree::Builder {
 public:
  Builder(DensityTree& tree, const Density& density, double v_origin, const Goal& goal)
      : tree_(tree), density_(density), v_origin_(v_origin), goal_(goal), places_(gauss_places(3)) {}

  void build() {
    make_roots();
    while (!is_done()) {
      const std::size_t worst = queue_.top().second;
      queue_.pop();
      halve(worst);
    }
    for (const Draft& draft : drafts_) tree_.cells_.push_back(draft.cell);
  }

  void audit() {
    const std::vector<WeightedPlace> places = audit_places();
    DensityAudit& audit = tree_.audit_;
    for (DensityCell& cell : tree_.cells_) {
      const std::vector<double> values = evaluate(cell, places);
      lift(cell, places, values);
      tree_.mass_ += cell.mass();
      for (std::size_t k = 0; k < places.size(); ++k) add_to_audit(audit, cell, places[k], values[k]);
    }
  }

 private:
  struct Draft {
    DensityCell cell;
    std::uint32_t node = 0;
    double off = 0.0;       // integral of |tree - density|
    double integral = 0.0;  // of the density
    double ratio = 0.0;     // the most of density / tree
    bool bends_in_v = true;
  };

  [[nodiscard]] bool is_done() const {
    if (queue_.empty() || drafts_.size() >= goal_.most_cells) return true;
    const bool is_close = off_ <= goal_.accuracy * integral_ && drafts_.size() >= kLeastCells;
    return is_close && queue_.top().first < kUrgent;
  }

  void make_roots() {
    const std::array breaks{0.0, tree_.v_break_, 1.0};
    for (std::size_t row = 0; row < 2; ++row) {
      for (std::size_t column = 0; column < kColumns; ++column) {
        DensityCell cell{.v = breaks[row], .w = static_cast<double>(column) / kColumns};
        cell.dv = breaks[row + 1] - breaks[row];
        cell.dw = 1.0 / kColumns;
        std::array<ChartPoint, 4> points;
        for (std::size_t k = 0; k < 4; ++k) points[k] = place(cell, corners()[k]);
        density_(points, cell.corner);
        tree_.evaluations_ += points.size();
        tree_.nodes_.push_back({.next = static_cast<std::uint32_t>(drafts_.size())});
        drafts_.push_back(assessed(cell, static_cast<std::uint32_t>(tree_.nodes_.size() - 1)));
        enter(drafts_.size() - 1);
      }
    }
  }

  [[nodiscard]] std::vector<double> evaluate(const DensityCell& cell, std::span<const WeightedPlace> places) {
    std::vector<ChartPoint> points;
    for (const WeightedPlace& p : places) points.push_back(place(cell, p.place));
    std::vector<double> values(points.size());
    density_(points, values);
    tree_.evaluations_ += points.size();
    return values;
  }

  [[nodiscard]] Draft assessed(const DensityCell& cell, std::uint32_t node) {
    const std::vector<double> f = evaluate(cell, places_);
    Draft draft{.cell = cell, .node = node};
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const double share = places_[k].weight * cell.dv * cell.dw;
      const double tabled = cell.at(place(cell, places_[k].place));
      draft.off += share * std::abs(f[k] - tabled);
      draft.integral += share * f[k];
      if (f[k] > 0.0) draft.ratio = std::max(draft.ratio, f[k] / tabled);
    }
    choose_axis(f, draft);
    return draft;
  }

  // Along the axis in which the three rows of points bend more. A ridge along an edge, which no point has met, bends
  // none of them: then the corners tell.
  void choose_axis(const std::vector<double>& f, Draft& draft) const {
    double bend_v = 0.0;
    double bend_w = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      bend_v += std::abs(f[3 * k] - 2.0 * f[3 * k + 1] + f[3 * k + 2]);
      bend_w += std::abs(f[k] - 2.0 * f[3 + k] + f[6 + k]);
    }
    const DensityCell& cell = draft.cell;
    const std::array<double, 4>& c = cell.corner;
    const double rise_v = std::abs(c[1] - c[0]) + std::abs(c[3] - c[2]);
    const double rise_w = std::abs(c[2] - c[0]) + std::abs(c[3] - c[1]);
    const double missed = draft.off / (cell.dv * cell.dw);
    if (rise_v + rise_w > 0.0) {
      bend_v += 2.0 * missed * rise_v / (rise_v + rise_w);
      bend_w += 2.0 * missed * rise_w / (rise_v + rise_w);
    }
    draft.bends_in_v = bend_v >= bend_w;
    if (is_peak_unmet(cell)) draft.bends_in_v = is_polar() || cell.dv >= cell.dw;
  }

  // Whether a peak at one of the cell's corners might be too narrow for its points.
  [[nodiscard]] bool is_peak_unmet(const DensityCell& cell) const {
    if (!goal_.has_peak) return false;
    const bool touches_v = cell.v <= v_origin_ && v_origin_ <= cell.v + cell.dv;
    if (is_polar()) return touches_v && cell.dv > kPeakWidth;
    const auto holds = [&](double w) { return cell.w <= w && w <= cell.w + cell.dw; };
    return touches_v && std::max(cell.dv, cell.dw) > kPeakWidth && (holds(0.0) || holds(0.5) || holds(1.0));
  }

  // At the normal every azimuth is the same place.
  [[nodiscard]] bool is_polar() const { return v_origin_ > 1.0 - kSliver; }

  void enter(std::size_t index) {
    const Draft& draft = drafts_[index];
    off_ += draft.off;
    integral_ += draft.integral;
    // Cells that are off by nothing are still halved until there are enough of them: by size.
    double priority = draft.off + 1e-12 * draft.cell.dv * draft.cell.dw;
    const bool counts = draft.integral > std::min(1e-3 * goal_.accuracy, 1e-6) * integral_;
    if ((draft.ratio > kSteep && counts) || is_peak_unmet(draft.cell)) priority += kUrgent;
    if (std::min(draft.cell.dv, draft.cell.dw) > kLeastWidth) queue_.emplace(priority, index);
  }

  void halve(std::size_t index) {
    const Draft draft = drafts_[index];
    off_ -= draft.off;
    integral_ -= draft.integral;
    const bool in_v = draft.bends_in_v;
    DensityCell low = draft.cell;
    DensityCell high = draft.cell;
    (in_v ? low.dv : low.dw) *= 0.5;
    (in_v ? high.dv : high.dw) *= 0.5;
    in_v ? high.v = low.v + low.dv : high.w = low.w + low.dw;
    const std::array<ChartPoint, 2> points{place(high, {0.0, 0.0}),
                                           in_v ? place(high, {0.0, 1.0}) : place(high, {1.0, 0.0})};
    std::array<double, 2> values{};
    density_(points, values);
    tree_.evaluations_ += points.size();
    const std::size_t other = in_v ? 2 : 1;  // the second corner on the halving line, seen from `high`
    high.corner[0] = low.corner[in_v ? 1 : 2] = values[0];
    high.corner[other] = low.corner[3] = values[1];

    const auto first = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.push_back({.next = static_cast<std::uint32_t>(index)});
    tree_.nodes_.push_back({.next = static_cast<std::uint32_t>(drafts_.size())});
    tree_.nodes_[draft.node] = {
        .middle = in_v ? high.v : high.w, .next = first, .kind = in_v ? Node::Kind::HalvedInV : Node::Kind::HalvedInW};
    drafts_[index] = assessed(low, first);
    drafts_.push_back(assessed(high, first + 1));
    enter(index);
    enter(drafts_.size() - 1);
  }

  static void lift(DensityCell& cell, std::span<const WeightedPlace> places, std::span<const double> values) {
    bool is_steep = false;
    for (std::size_t k = 0; k < places.size(); ++k)
      is_steep = is_steep || values[k] > kSteep * cell.at(place(cell, places[k].place));
    if (!is_steep) return;
    constexpr double kMargin = 2.0;  // for what lies between the points
    const double most = kMargin * *std::ranges::max_element(values);
    for (double& corner : cell.corner) corner = std::max(corner, most);
  }

  static void add_to_audit(DensityAudit& audit, const DensityCell& cell, const WeightedPlace& p, double value) {
    const double tabled = cell.at(place(cell, p.place));
    const double share = p.weight * cell.dv * cell.dw;
    audit.integral += share * value;
    audit.absolute += share * std::abs(tabled - value);
    if (tabled <= 0.0) return;  // never drawn
    audit.relative_square += share * (tabled - value) * (tabled - value) / tabled;
    audit.most_ratio = std::max(audit.most_ratio, value / tabled);
  }

  static constexpr double kUrgent = 1e200;  // above the error of any cell

  DensityTree& tree_;
  const Density& density_;
  double v_origin_;
  Goal goal_;
  std::vector<WeightedPlace> places_;
  std::vector<Draft> drafts_;
  std::priority_queue<std::pair<double, std::size_t>> queue_;
  double off_ = 0.0;
  double integral_ = 0.0;
};

DensityTree::DensityTree(const Density& density, double v_origin, const Goal& goal) {
  // The origin lies on the line between the roots, unless that would leave slivers.
  v_break_ = v_origin < kSliver || v_origin > 1.0 - kSliver ? 0.5 : v_origin;
  Builder builder(*this, density, v_origin, goal);
  builder.build();
  builder.audit();
}

double DensityTree::at(ChartPoint p) const {
  const std::size_t row = p.v < v_break_ ? 0 : 1;
  const std::size_t column = std::min(static_cast<std::size_t>(p.w * kColumns), kColumns - 1);
  const Node* node = &nodes_[row * kColumns + column];
  while (node->kind != Node::Kind::Cell) {
    const double place = node->kind == Node::Kind::HalvedInV ? p.v : p.w;
    node = &nodes_[node->next + (place < node->middle ? 0U : 1U)];
  }
  return cells_[node->next].at(p);
}

}  // namespace gonio::reflectance
