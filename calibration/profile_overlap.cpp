#include "calibration/profile_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace gonio::calibration {
namespace {

constexpr std::array<RadialNode, 1> kEven{RadialNode{1.0, 1.0}};

std::span<const RadialNode> nodes_of(const std::vector<RadialNode>& profile) {
  return profile.empty() ? std::span<const RadialNode>(kEven) : std::span<const RadialNode>(profile);
}

// How much longer than across the beam its picture on the surface is along this azimuth.
double lengthening(Angle theta, Angle phi, double azimuth) {
  const double along = std::cos(azimuth - phi.si()) * std::sin(theta.si());
  return 1.0 / std::sqrt(1.0 - along * along);
}

class Along {
 public:
  Along(std::span<const RadialNode> nodes, double unit_mm) : nodes_(nodes), unit_mm_(unit_mm) {}

  [[nodiscard]] double end_mm() const { return nodes_.back().of_radius * unit_mm_; }
  // The next node beyond `radius_mm`.
  [[nodiscard]] double next_mm(double radius_mm) {
    while (place_ < nodes_.size() && nodes_[place_].of_radius * unit_mm_ <= radius_mm) ++place_;
    return place_ < nodes_.size() ? nodes_[place_].of_radius * unit_mm_ : std::numeric_limits<double>::infinity();
  }
  // value + slope r, up to the node that next_mm gave.
  [[nodiscard]] std::array<double, 2> line() const {
    if (place_ == 0) return {nodes_.front().value, 0.0};
    const RadialNode& a = nodes_[place_ - 1];
    const RadialNode& b = nodes_[place_];
    const double slope = (b.value - a.value) / ((b.of_radius - a.of_radius) * unit_mm_);
    return {a.value - slope * a.of_radius * unit_mm_, slope};
  }

 private:
  std::span<const RadialNode> nodes_;
  double unit_mm_;
  std::size_t place_ = 0;
};

class AzimuthIntegrand {
 public:
  AzimuthIntegrand(const OverlapModel& model, std::optional<Length> target_radius, const Geometry& g)
      : model_(model),
        g_(g),
        target_mm_(target_radius ? in_millimetres(*target_radius) : std::numeric_limits<double>::infinity()) {}

  // integral e w r dr
  [[nodiscard]] double operator()(double azimuth) const {
    Along spot(nodes_of(model_.spot_profile),
               in_millimetres(model_.spot_radius.value) * lengthening(g_.theta_i, g_.phi_i, azimuth));
    Along field(nodes_of(model_.field_profile),
                in_millimetres(model_.field_radius.value) * lengthening(g_.theta_r, g_.phi_r, azimuth));
    const double end = std::min({spot.end_mm(), field.end_mm(), target_mm_});
    double sum = 0.0;
    for (double from = 0.0; from < end;) {
      const double to = std::min({spot.next_mm(from), field.next_mm(from), end});
      const auto [e0, e1] = spot.line();
      const auto [w0, w1] = field.line();
      const double a2 = from * from;
      const double b2 = to * to;
      sum += e0 * w0 * (b2 - a2) / 2.0 + (e0 * w1 + e1 * w0) * (b2 * to - a2 * from) / 3.0 +
             e1 * w1 * (b2 * b2 - a2 * a2) / 4.0;
      from = to;
    }
    return sum;
  }

 private:
  const OverlapModel& model_;
  const Geometry& g_;
  double target_mm_;
};

/// By the finer rule, and how far the coarser one is from it.
struct RulePair {
  double value = 0.0;
  double error = 0.0;
};

// Gauss-Kronrod 7, 15 (Piessens et al. 1983, QUADPACK qk15).
RulePair kronrod(const AzimuthIntegrand& f, double from, double to) {
  static constexpr std::array<double, 8> kNodes{
      0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
      0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
      0.586087235467691130294144691693013, 0.405845151377397166906606412076961,
      0.207784955007898467600689403773245, 0.0};
  static constexpr std::array<double, 8> kWeights{
      0.022935322010529224963732008058970, 0.063092092629978553290700663189204, 0.104790010322250183839876322541518,
      0.140653259715525918745189590510238, 0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
      0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
  static constexpr std::array<double, 4> kGauss{
      0.129484966168869693270611432679082, 0.279705391489276667901467771423780, 0.381830050505118944950369775488975,
      0.417959183673469387755102040816327};
  const double half = 0.5 * (to - from);
  const double middle = 0.5 * (to + from);
  double fine = 0.0;
  double coarse = 0.0;
  for (std::size_t k = 0; k < kNodes.size(); ++k) {
    const bool is_middle = k + 1 == kNodes.size();
    const double sum = is_middle ? f(middle) : f(middle - half * kNodes[k]) + f(middle + half * kNodes[k]);
    fine += kWeights[k] * sum;
    if (k % 2 == 1) coarse += kGauss[k / 2] * sum;
  }
  return {half * fine, half * std::abs(fine - coarse)};
}

/// Half a turn in parts, ending where the outer edges of two of spot, field and target cross: a profile may fall to
/// nothing there, and a kink beside the end of a part would pass unseen between its nodes.
std::vector<double> azimuths_of_kinks(const OverlapModel& model, const std::optional<Length>& target_radius,
                                      const Geometry& g) {
  constexpr int kParts = 4;
  constexpr double kHalfTurn = std::numbers::pi;
  struct Edge {
    double radius_mm = 0.0;
    Angle theta;
    Angle phi;
  };
  std::vector<Edge> ends{
      {nodes_of(model.spot_profile).back().of_radius * in_millimetres(model.spot_radius.value), g.theta_i, g.phi_i},
      {nodes_of(model.field_profile).back().of_radius * in_millimetres(model.field_radius.value), g.theta_r, g.phi_r}};
  if (target_radius) ends.push_back({in_millimetres(*target_radius), {}, {}});
  std::vector<double> azimuths;
  for (int k = 0; k <= kParts; ++k) azimuths.push_back(kHalfTurn * k / kParts);
  // 1 / r^2 = (1 - sin^2 theta cos^2(azimuth - phi)) / radius^2 = a - b cos 2 (azimuth - phi)
  for (std::size_t k = 0; k < ends.size(); ++k) {
    for (std::size_t l = 0; l < k; ++l) {
      double even = 0.0;
      double cosine = 0.0;
      double sine = 0.0;
      for (const auto& [edge, sign] : {std::pair{&ends[k], 1.0}, std::pair{&ends[l], -1.0}}) {
        const double unit = sign / (edge->radius_mm * edge->radius_mm);
        const double half = 0.5 * unit * std::pow(std::sin(edge->theta.si()), 2);
        even += unit - half;
        cosine -= half * std::cos(2.0 * edge->phi.si());
        sine -= half * std::sin(2.0 * edge->phi.si());
      }
      const double most = std::hypot(cosine, sine);
      if (most <= std::abs(even)) continue;
      for (const double side : {-1.0, 1.0}) {
        const double turns = (std::atan2(sine, cosine) + side * std::acos(-even / most)) / (2.0 * kHalfTurn);
        azimuths.push_back(kHalfTurn * (turns - std::floor(turns)));
      }
    }
  }
  std::sort(azimuths.begin(), azimuths.end());
  return azimuths;
}

// Both halves beside the whole: at a kink the two rules may agree by chance, the halves then do not.
double integrate(const AzimuthIntegrand& f, double from, double to, const RulePair& whole, double tolerance,
                 int depth) {
  const double middle = 0.5 * (from + to);
  const RulePair left = kronrod(f, from, middle);
  const RulePair right = kronrod(f, middle, to);
  const double value = left.value + right.value;
  const double error = std::max(whole.error, std::abs(whole.value - value));
  if (error <= tolerance || depth == 0) return value;
  return integrate(f, from, middle, left, 0.5 * tolerance, depth - 1) +
         integrate(f, middle, to, right, 0.5 * tolerance, depth - 1);
}

}  // namespace

double profile_overlap_mm2(const OverlapModel& model, std::optional<Length> target_radius, const Geometry& g) {
  constexpr int kDepth = 30;
  constexpr double kRelative = 1e-10;
  const AzimuthIntegrand f(model, target_radius, g);
  const std::vector<double> edges = azimuths_of_kinks(model, target_radius, g);
  std::vector<RulePair> parts;
  double coarse = 0.0;
  for (std::size_t k = 1; k < edges.size(); ++k) coarse += parts.emplace_back(kronrod(f, edges[k - 1], edges[k])).value;
  const double tolerance = kRelative * coarse / static_cast<double>(parts.size());
  double sum = 0.0;
  for (std::size_t k = 1; k < edges.size(); ++k) {
    sum += integrate(f, edges[k - 1], edges[k], parts[k - 1], tolerance, kDepth);
  }
  return 2.0 * sum;  // the other half turn is the same
}

}  // namespace gonio::calibration
