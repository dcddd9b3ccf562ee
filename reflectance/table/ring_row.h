#pragma once

#include <cstdint>
#include <vector>

#include "reflectance/table/mesh_row.h"
#include "reflectance/table/stencil.h"

namespace gonio::reflectance {

/// What the azimuths of a row mean.
enum class RowAzimuths : std::uint8_t {
  Full,    ///< over 360 deg
  Folded,  ///< those with y >= 0 stand for their mirror images too
  None,    ///< no azimuth matters, as at theta_i = 0 of an isotropic surface: one node a ring
};

/// Directions of one incidence on rings of common theta_r: linear along each ring, over 360 deg, and linear in theta
/// between two rings. Immutable; threads: any.
class RingRow {
 public:
  /// `nodes`, not empty, whose thetas differ by less than `tolerance` [rad] share a ring. Where no node is at the pole,
  /// one is added to `nodes`: the mean of the first ring.
  RingRow(std::vector<TableNode>& nodes, double tolerance, RowAzimuths azimuths);

  [[nodiscard]] Stencil locate(const Vector& r) const;
  /// The nodes of which the added pole is the mean; none where it was measured.
  [[nodiscard]] std::vector<std::size_t> nodes_of_pole() const;
  /// The same without node k: along its ring, and across it from the two next ones. Nothing where there is neither.
  [[nodiscard]] std::vector<Stencil> locate_without(std::size_t k) const;
  /// Hands out the nodes of a quadrature over the hemisphere whose cells are those of the rings.
  void quadrature(int order, const QuadratureSink& sink) const;

 private:
  struct RingNode {
    double phi;  ///< (-pi, pi], [0, pi] folded [rad]
    std::size_t node;
  };
  struct Ring {
    double theta;
    std::vector<RingNode> nodes;  ///< phi ascending
  };
  /// Two neighbours along a ring and the weight of the second.
  struct Along {
    std::size_t first;
    std::size_t second;
    double weight;
    double gap;  ///< between them [rad of phi]
  };

  [[nodiscard]] Along along(const Ring& ring, double phi) const;
  void add(Stencil& stencil, const Ring& ring, double phi, double weight) const;
  [[nodiscard]] std::vector<double> azimuths(const Ring& inner, const Ring& outer) const;

  std::vector<Ring> rings_;
  double pole_width_ = 0.0;  ///< of the first cell, when its pole is not measured
  RowAzimuths meaning_;
  bool is_folded_;
};

}  // namespace gonio::reflectance
