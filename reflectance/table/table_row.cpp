#include "reflectance/table/table_row.h"

#include <cmath>
#include <utility>

namespace gonio::reflectance {
namespace {

// Of the nodes off the plane of incidence.
void add_mirror_images(MergedNodes& nodes, double tolerance) {
  const std::size_t measured = nodes.nodes.size();
  for (std::size_t k = 0; k < measured; ++k) {
    TableNode image = nodes.nodes[k];
    if (image.r.y <= 0.5 * tolerance) continue;
    image.r.y = -image.r.y;
    nodes.nodes.push_back(image);
    nodes.origins.push_back(Origins(nodes.origins[k]));
  }
}

// Of a pole that was added.
Origins mean_of(const std::vector<std::size_t>& nodes, const std::vector<Origins>& origins) {
  Origins mean;
  const auto count = static_cast<double>(nodes.size());
  for (const std::size_t k : nodes) {
    for (const ReadingShare& share : origins[k]) {
      mean.push_back({.reading = share.reading, .weight = share.weight / count});
    }
  }
  return mean;
}

}  // namespace

Result<TableRow> TableRow::make(Angle theta_i, Angle phi_i, MergedNodes nodes, RowAzimuths azimuths,
                                const TableOptions& options) {
  const std::size_t measured = nodes.nodes.size();
  const double tolerance = options.same_direction.si();
  if (options.layout == TableLayout::Rings || azimuths == RowAzimuths::None) {
    RingRow rings(nodes.nodes, tolerance, azimuths);
    if (nodes.nodes.size() > measured) nodes.origins.push_back(mean_of(rings.nodes_of_pole(), nodes.origins));
    return TableRow(theta_i, phi_i, std::move(nodes), measured, std::move(rings), azimuths == RowAzimuths::None,
                    options);
  }
  if (azimuths == RowAzimuths::Folded) add_mirror_images(nodes, tolerance);
  Result<MeshRow> mesh = MeshRow::make(nodes.nodes);
  if (!mesh) return failure(std::move(mesh).error());
  return TableRow(theta_i, phi_i, std::move(nodes), measured, std::move(*mesh), false, options);
}

TableRow::TableRow(Angle theta_i, Angle phi_i, MergedNodes nodes, std::size_t measured,
                   std::variant<RingRow, MeshRow> place, bool is_profile, const TableOptions& options)
    : theta_i_(theta_i),
      phi_i_(phi_i),
      tilt_{.mu = std::max(0.0, std::cos(theta_i.si())), .sin_theta = std::sin(theta_i.si())},
      nodes_(std::move(nodes.nodes)),
      origins_(std::move(nodes.origins)),
      measured_(measured),
      place_(std::move(place)),
      widest_cell_(options.widest_cell.si()),
      is_profile_(is_profile) {
  if (options.beyond == BeyondReach::Continue) continuation_ = Continuation(nodes_);
}

Stencil TableRow::locate(const Vector& r) const {
  const auto* mesh = std::get_if<MeshRow>(&place_);
  return mesh != nullptr ? mesh->locate(r) : std::get<RingRow>(place_).locate(r);
}

double TableRow::sum(const Stencil& stencil) const {
  double f = 0.0;
  for (std::size_t k = 0; k < stencil.size; ++k) f += stencil.weight[k] * nodes_[stencil.node[k]].f;
  return f;
}

// Where a node stands for all azimuths, all of them are that of the nodes.
Vector TableRow::in_profile(const Vector& r) const {
  return is_profile_ ? Vector{.x = std::hypot(r.x, r.y), .y = 0.0, .z = r.z} : r;
}

double TableRow::continued(const Vector& r, const Vector& edge) const {
  return continuation_(in_profile(r)) - continuation_(in_profile(edge));
}

double TableRow::value(const Vector& r) const {
  const Stencil stencil = locate(r);
  const double f = sum(stencil);
  return stencil.is_inside ? f : f + continued(r, stencil.place);
}

TableRow::Value TableRow::value_and_more(const Vector& r) const {
  const Stencil stencil = locate(r);
  Value value{.f = sum(stencil), .is_covered = is_covered(stencil)};
  const Vector from = in_profile(stencil.place);
  for (std::size_t k = 0; k < stencil.size; ++k) {
    const TableNode& node = nodes_[stencil.node[k]];
    value.u += stencil.weight[k] * node.u;
    value.distance += stencil.weight[k] * arc(node.r, from);
  }
  if (!stencil.is_inside) {
    value.f += continued(r, stencil.place);
    value.distance += arc(stencil.place, r);
  }
  return value;
}

std::optional<std::size_t> TableRow::measured_node(std::size_t k) const {
  if (k < measured_) return k;
  const Vector image{nodes_[k].r.x, -nodes_[k].r.y, nodes_[k].r.z};
  for (std::size_t n = 0; n < measured_; ++n) {
    if (nodes_[n].r == image) return n;
  }
  return std::nullopt;
}

std::optional<std::vector<double>> TableRow::bends(const Vector& r) const {
  const auto* mesh = std::get_if<MeshRow>(&place_);
  if (mesh == nullptr) return std::nullopt;
  std::vector<double> off;
  for (const MeshRow::FarNode& far : mesh->across(r)) {
    double continued = 0.0;
    for (std::size_t k = 0; k < far.corner.size(); ++k) continued += far.weight[k] * nodes_[far.corner[k]].f;
    off.push_back(nodes_[far.node].f - continued);
  }
  return off;
}

std::size_t TableRow::neighbourhoods() const {
  return std::holds_alternative<RingRow>(place_) && !is_profile_ ? 2 : 1;
}

std::vector<double> TableRow::without(std::size_t k) const {
  std::vector<double> told;
  if (const auto* rings = std::get_if<RingRow>(&place_)) {
    for (const Stencil& stencil : rings->locate_without(k)) told.push_back(sum(stencil));
    return told;
  }
  const Vector image{nodes_[k].r.x, -nodes_[k].r.y, nodes_[k].r.z};
  std::optional<std::size_t> image_node;
  for (std::size_t n = measured_; n < nodes_.size(); ++n) {
    if (nodes_[n].r == image) image_node = n;
  }
  if (const auto stencil = std::get<MeshRow>(place_).locate_without(k, image_node)) told.push_back(sum(*stencil));
  return told;
}

bool TableRow::quadrature(int order, const QuadratureSink& sink) const {
  if (const auto* mesh = std::get_if<MeshRow>(&place_)) return mesh->quadrature(order, sink);
  std::get<RingRow>(place_).quadrature(order, sink);
  return true;
}

}  // namespace gonio::reflectance
