#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "base/result.h"
#include "reflectance/table/continuation.h"
#include "reflectance/table/feature_motion.h"
#include "reflectance/table/merge_readings.h"
#include "reflectance/table/mesh_row.h"
#include "reflectance/table/ring_row.h"
#include "reflectance/table/table_options.h"

namespace gonio::reflectance {

/// All that is known of one incidence. Directions are in its frame: x points along phi_i. Immutable; threads: any.
class TableRow {
 public:
  /// What stands at a direction, and by what right.
  struct Value {
    double f = 0.0;
    double u = 0.0;
    bool is_covered = false;
    double distance = 0.0;  ///< to the readings it comes from, weighted as they are; 0 at a reading [rad]
  };

  /// `nodes` not empty. Errors: InvalidInput when scattered directions lie on one line.
  [[nodiscard]] static Result<TableRow> make(Angle theta_i, Angle phi_i, MergedNodes nodes, RowAzimuths azimuths,
                                             const TableOptions& options);

  [[nodiscard]] double value(const Vector& r) const;
  [[nodiscard]] Value value_and_more(const Vector& r) const;
  /// The nodes that make up `value(r)` (without a continuation beyond the reach), and of which readings each is made.
  [[nodiscard]] Stencil stencil(const Vector& r) const { return locate(r); }
  [[nodiscard]] const Origins& origins(std::size_t node) const { return origins_[node]; }
  /// A node of a stencil: one of `nodes()`, or one that was added.
  [[nodiscard]] const TableNode& node(std::size_t k) const { return nodes_[k]; }
  /// The one of `nodes()` that a node of a stencil is, or is the mirror image of; nothing for a pole that was added.
  [[nodiscard]] std::optional<std::size_t> measured_node(std::size_t k) const;
  /// Whether a stencil lies within the reach, in no hole.
  [[nodiscard]] bool is_covered(const Stencil& s) const { return s.is_inside && s.width <= widest_cell_; }
  /// What the other readings of this incidence would say of node k: nothing, one answer, or two.
  [[nodiscard]] std::vector<double> without(std::size_t k) const;
  /// Of scattered views: how far each node across a side of the triangle at r lies off that triangle, continued to
  /// there; up to three. Nothing on rings.
  [[nodiscard]] std::optional<std::vector<double>> bends(const Vector& r) const;
  /// How many answers `without` has where neighbours lie all around: two on rings, along and across, else one.
  [[nodiscard]] std::size_t neighbourhoods() const;
  /// See MeshRow::quadrature.
  [[nodiscard]] bool quadrature(int order, const QuadratureSink& sink) const;

  [[nodiscard]] Angle theta_i() const { return theta_i_; }
  [[nodiscard]] Angle phi_i() const { return phi_i_; }
  [[nodiscard]] const IncidenceTilt& tilt() const { return tilt_; }
  /// The measured ones, without what was added to complete them.
  [[nodiscard]] std::span<const TableNode> nodes() const { return std::span(nodes_).first(measured_); }

 private:
  TableRow(Angle theta_i, Angle phi_i, MergedNodes nodes, std::size_t measured, std::variant<RingRow, MeshRow> place,
           bool is_profile, const TableOptions& options);
  [[nodiscard]] Stencil locate(const Vector& r) const;
  [[nodiscard]] double sum(const Stencil& stencil) const;
  [[nodiscard]] Vector in_profile(const Vector& r) const;
  [[nodiscard]] double continued(const Vector& r, const Vector& edge) const;

  Angle theta_i_;
  Angle phi_i_;
  IncidenceTilt tilt_;
  std::vector<TableNode> nodes_;
  std::vector<Origins> origins_;  ///< as many
  std::size_t measured_;
  std::variant<RingRow, MeshRow> place_;
  Continuation continuation_;
  double widest_cell_;
  bool is_profile_;  ///< a node stands for all azimuths
};

}  // namespace gonio::reflectance
