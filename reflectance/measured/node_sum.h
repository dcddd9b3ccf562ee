#pragma once

#include <optional>
#include <span>
#include <vector>

#include "reflectance/measured/cap_model.h"
#include "reflectance/measured/measured_scan.h"
#include "reflectance/measured/pair_nodes.h"
#include "reflectance/measured/scan_interpolant.h"

namespace gonio::reflectance {

/// An integral over a scan, taken apart.
struct NodeSum {
  double measured = 0.0;               ///< where readings surround the nodes
  double modelled = 0.0;               ///< elsewhere
  std::vector<double> weight;          ///< d value / d reading, of both parts; as many as points of the scan
  std::vector<double> rival_modelled;  ///< `modelled` by each of the cap's rivals
  std::vector<double> rival_weight;    ///< how much each counts; with that of the cap itself they sum to 1
  double u_lack_of_fit = 0.0;          ///< of `modelled`, by a cap that is not quite the readings' surface
  [[nodiscard]] double value() const { return measured + modelled; }
};

/// Sums the nodes over the interpolant, and over the cap where it does not cover them.
[[nodiscard]] NodeSum node_sum(const MeasuredScan& scan, const ScanInterpolant& interpolant,
                               const std::optional<CapModel>& cap, std::span<const PairNode> nodes);

/// The value alone, and only in its two parts.
[[nodiscard]] NodeSum bare_node_sum(const ScanInterpolant& interpolant, std::span<const PairNode> nodes);

/// u of a weighted sum of readings, apart for what they share and what not.
struct SumUncertainty {
  double random = 0.0;
  double shared = 0.0;
};
[[nodiscard]] SumUncertainty sum_uncertainty(const MeasuredScan& scan, std::span<const double> weight);

}  // namespace gonio::reflectance
