#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reflectance/table/stencil.h"
#include "reflectance/table/table_options.h"
#include "reflectance/table/table_reading.h"
#include "reflectance/table/table_report.h"

namespace gonio::reflectance {

/// A checked reading with its direction in the frame of its incidence.
struct PlacedReading {
  Vector r;
  const TableReading* reading = nullptr;
  std::uint32_t index = 0;  ///< of the reading
};

/// Nodes, and of which readings each is made.
struct MergedNodes {
  std::vector<TableNode> nodes;
  std::vector<Origins> origins;  ///< as many
};

/// Makes one node of all readings that lie within `tolerance` [rad] of the first of them, the pole's among them; adds
/// each such group to `report`.
[[nodiscard]] MergedNodes merged_nodes(std::span<const PlacedReading> readings, double tolerance, TableReport& report);

/// Makes rings of one node each, whatever the azimuths: for theta_i = 0 of a surface that no turn changes. Readings on
/// common thetas give one ring a theta, others rings of eight.
[[nodiscard]] MergedNodes profile_nodes(const MergedNodes& nodes, double tolerance);

}  // namespace gonio::reflectance
