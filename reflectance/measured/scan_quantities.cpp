#include "reflectance/measured/scan_quantities.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "reflectance/light/quantity_name.h"
#include "reflectance/measured/node_sum.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

// What a difference of two ways is worth as a standard uncertainty: anything up to it, alike.
double as_rectangle(double difference) {
  return std::abs(difference) / std::sqrt(3.0);
}

struct LevelNodes {
  std::vector<PairNode> fine;
  std::vector<PairNode> coarse;
};

// `make(level)` for both.
template <class Make>
LevelNodes at_both_levels(Make make) {
  return {.fine = make(NodeLevel::Fine), .coarse = make(NodeLevel::Coarse)};
}

// rho_dh of each incidence, by its weight.
std::vector<PairNode> views_of(const std::vector<HemisphereNode>& incidences, double scale, Feature feature,
                               NodeLevel level) {
  std::vector<PairNode> nodes;
  for (const HemisphereNode& i : incidences) {
    for (const HemisphereNode& r : feature_nodes(i.direction, feature, level)) {
      nodes.push_back({.pair = {.i = i.direction, .r = r.direction}, .weight = scale * i.weight_sr * r.weight_sr});
    }
  }
  return nodes;
}

double total(const std::vector<HemisphereNode>& nodes) {
  double sum = 0.0;
  for (const HemisphereNode& node : nodes) sum += node.weight_sr;
  return sum;
}

// The variance that the choice among models adds (Burnham and Anderson 2002, eq 4.9).
double between_models(const NodeSum& sum) {
  double weight = 1.0;
  for (const double of_rival : sum.rival_weight) weight -= of_rival;
  double mean = weight * sum.modelled;
  for (std::size_t m = 0; m < sum.rival_weight.size(); ++m) mean += sum.rival_weight[m] * sum.rival_modelled[m];
  double variance = weight * (sum.modelled - mean) * (sum.modelled - mean);
  for (std::size_t m = 0; m < sum.rival_weight.size(); ++m) {
    const double off = sum.rival_modelled[m] - mean;
    variance += sum.rival_weight[m] * off * off;
  }
  // About the value that is reported, which is that of the best model and not the mean.
  return std::sqrt(std::max(0.0, variance + (sum.modelled - mean) * (sum.modelled - mean)));
}

}  // namespace

Result<ScanQuantities> ScanQuantities::make(MeasuredScan scan, const InterpolationOptions& options,
                                            std::optional<CapModel> cap) {
  Result<Interpolation> interpolation = interpolate_scan(scan, options);
  if (!interpolation) return failure(std::move(interpolation).error());
  if (cap) {
    for (const CapModel::Parameter& p : cap->parameters) {
      if (p.per_reading.size() == scan.points.size() && p.shift != 0.0) continue;
      return failure({.code = ErrorCode::InvalidInput,
                      .tried = fmt::format("integrate the scan \"{}\" with a cap model", scan.name),
                      .seen = fmt::format("{} dependences on readings, a shift of {}", p.per_reading.size(), p.shift),
                      .limit = fmt::format("as many as its {} points, a shift other than 0", scan.points.size())});
    }
  }
  return ScanQuantities(std::move(scan), *std::move(interpolation), std::move(cap));
}

ScanQuantities::ScanQuantities(MeasuredScan scan, Interpolation interpolation, std::optional<CapModel> cap)
    : scan_(std::move(scan)), interpolation_(std::move(interpolation)), cap_(std::move(cap)) {}

ScanQuantity ScanQuantities::of(const char* name, const std::vector<PairNode>& fine,
                                const std::vector<PairNode>& coarse) const {
  const ScanInterpolant& best = interpolation_.best();
  const NodeSum sum = node_sum(scan_, best, cap_, fine);
  const SumUncertainty readings = sum_uncertainty(scan_, sum.weight);
  ScanQuantity q{.name = name,
                 .unit = std::string(find_quantity(name).value().unit),
                 .value = sum.value(),
                 .u_random = readings.random,
                 .u_shared = readings.shared};
  q.u_interpolation = interpolation_.candidates.front().u_relative * std::abs(sum.measured);
  if (const ScanInterpolant* next = interpolation_.next()) {
    const NodeSum other = bare_node_sum(*next, fine);
    const double between = as_rectangle(other.measured - sum.measured);
    if (interpolation_.rival() != nullptr) q.u_interpolation = std::max(q.u_interpolation, between);
    if (!cap_) q.u_modelled = as_rectangle(other.modelled - sum.modelled);
  }
  if (cap_) q.u_modelled = std::hypot(between_models(sum), sum.u_lack_of_fit);
  // The quadrature is the same for any values: the interpolant alone tells how far its levels are apart.
  const NodeSum finer = bare_node_sum(best, fine);
  const NodeSum coarser = bare_node_sum(best, coarse);
  q.u_quadrature = as_rectangle(finer.value() - coarser.value());
  q.modelled_share = sum.value() != 0.0 ? sum.modelled / sum.value() : 0.0;
  q.u = std::sqrt(q.u_random * q.u_random + q.u_shared * q.u_shared + q.u_interpolation * q.u_interpolation +
                  q.u_modelled * q.u_modelled + q.u_quadrature * q.u_quadrature);
  q.expanded = q.k * q.u;
  return q;
}

Result<void> ScanQuantities::check_incidence(const Direction& i) const {
  if (cap_ || interpolation_.best().table().bracket(i).is_covered) return {};
  Angle first = degrees(90.0);
  Angle last;
  for (const TableRow& row : interpolation_.best().table().rows()) {
    first = std::min(first, row.theta_i());
    last = std::max(last, row.theta_i());
  }
  return failure(
      {.code = ErrorCode::InvalidInput,
       .tried = fmt::format("integrate the scan \"{}\" under theta_i {:.6g} deg", scan_.name, in_degrees(i.theta())),
       .seen = fmt::format("it was measured under {:.6g} to {:.6g} deg", in_degrees(first), in_degrees(last)),
       .limit = "a measured incidence, or a fitted model that goes on from there"});
}

Result<void> ScanQuantities::check_incidences() const {
  const auto rows = interpolation_.best().table().rows();
  const auto [first, last] = std::minmax_element(
      rows.begin(), rows.end(), [](const TableRow& a, const TableRow& b) { return a.theta_i() < b.theta_i(); });
  if (cap_ || last->theta_i() - first->theta_i() > interpolation_.best().table().options().same_direction) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = fmt::format("integrate the scan \"{}\" over incidences", scan_.name),
                  .seen = fmt::format("it has one theta_i only, {:.6g} deg", in_degrees(first->theta_i())),
                  .limit = "two or more, or a fitted model that goes on from there"});
}

Result<void> ScanQuantities::check_light(const std::vector<HemisphereNode>& nodes) const {
  for (const HemisphereNode& node : nodes) {
    if (node.direction.theta() != nodes.front().direction.theta()) return check_incidences();
  }
  return check_incidence(nodes.front().direction);
}

Result<ScanQuantity> ScanQuantities::rho_dh(const Direction& i) const {
  GONIO_TRY(check_incidence(i));
  const std::vector<HemisphereNode> one{{.direction = i, .weight_sr = 1.0}};
  const LevelNodes nodes =
      at_both_levels([&](NodeLevel level) { return views_of(one, 1.0, interpolation_.best().feature(), level); });
  return of("rho_dh", nodes.fine, nodes.coarse);
}

Result<ScanQuantity> ScanQuantities::rho_hd(const Direction& r) const {
  GONIO_TRY(check_incidences());
  const LevelNodes nodes = at_both_levels([&](NodeLevel level) {
    std::vector<PairNode> all;
    for (const HemisphereNode& i : feature_nodes(r, interpolation_.best().feature(), level)) {
      all.push_back({.pair = {.i = i.direction, .r = r}, .weight = i.weight_sr});
    }
    return all;
  });
  return of("rho_hd", nodes.fine, nodes.coarse);
}

Result<ScanQuantity> ScanQuantities::bond_albedo() const {
  GONIO_TRY(check_incidences());
  const ScanInterpolant& best = interpolation_.best();
  const LevelNodes nodes = at_both_levels([&](NodeLevel level) {
    return views_of(incidence_nodes(best.is_isotropic(), level), 1.0 / kPi, best.feature(), level);
  });
  return of("bond_albedo", nodes.fine, nodes.coarse);
}

Result<ScanQuantity> ScanQuantities::radf_normal_incidence(const Direction& r) const {
  GONIO_TRY(check_incidence(Direction()));
  const std::vector<PairNode> one{{.pair = {.i = Direction(), .r = r}, .weight = kPi}};
  return of("radf_normal_incidence", one, one);
}

Result<ScanQuantity> ScanQuantities::reflectance_under(const Light& light) const {
  const bool is_isotropic = interpolation_.best().is_isotropic();
  const auto coarse = light_nodes(light, is_isotropic, NodeLevel::Coarse);
  const auto fine = light_nodes(light, is_isotropic, NodeLevel::Fine);
  if (!fine) return failure(fine.error());
  if (!coarse) return failure(coarse.error());
  GONIO_TRY(check_light(*fine));
  const LevelNodes nodes = at_both_levels([&](NodeLevel level) {
    const std::vector<HemisphereNode>& lit = level == NodeLevel::Fine ? *fine : *coarse;
    return views_of(lit, 1.0 / total(lit), interpolation_.best().feature(), level);
  });
  return of("irradiance_reflectance", nodes.fine, nodes.coarse);
}

Result<ScanQuantity> ScanQuantities::remote_sensing_reflectance(const Light& light, const Direction& r) const {
  const auto coarse = light_nodes(light, false, NodeLevel::Coarse);
  const auto fine = light_nodes(light, false, NodeLevel::Fine);
  if (!fine) return failure(fine.error());
  if (!coarse) return failure(coarse.error());
  GONIO_TRY(check_light(*fine));
  const LevelNodes nodes = at_both_levels([&](NodeLevel level) {
    const std::vector<HemisphereNode>& lit = level == NodeLevel::Fine ? *fine : *coarse;
    std::vector<PairNode> all;
    for (const HemisphereNode& i : lit) {
      all.push_back({.pair = {.i = i.direction, .r = r}, .weight = i.weight_sr / total(lit)});
    }
    return all;
  });
  return of("remote_sensing_reflectance", nodes.fine, nodes.coarse);
}

}  // namespace gonio::reflectance
