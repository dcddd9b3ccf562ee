#pragma once

#include <span>
#include <vector>

#include "base/result.h"
#include "base/units.h"
#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// A sky given on a grid, bilinear in theta and phi between its points, closed in phi. All readings of the row at theta
/// = 0 are of one direction and are merged into their mean.
class TableSky {
 public:
  /// `thetas` ascending from 0 to 90 deg, both included; `phis` ascending, within less than 360 deg, one of them for a
  /// sky alike all around; `radiances` [theta][phi], phi fastest, finite, at least 0 [W m^-2 sr^-1 or relative].
  /// Errors: InvalidInput, naming row and column.
  [[nodiscard]] static Result<TableSky> make(std::vector<Angle> thetas, std::vector<Angle> phis,
                                             std::span<const double> radiances);

  [[nodiscard]] double radiance(const Direction& i) const;
  [[nodiscard]] bool is_zonal() const { return phis_.size() == 1; }
  [[nodiscard]] double ring_mean(const Direction& i) const;
  [[nodiscard]] std::vector<Angle> theta_breaks() const;
  [[nodiscard]] std::vector<Angle> phi_breaks() const { return phis_; }

 private:
  struct Place;  ///< between two nodes of one axis
  TableSky(std::vector<Angle> thetas, std::vector<Angle> phis, std::span<const double> radiances);
  [[nodiscard]] Place theta_place(Angle theta) const;
  [[nodiscard]] Place phi_place(Angle phi) const;
  [[nodiscard]] double at(std::size_t row, const Place& phi) const;

  std::vector<Angle> thetas_;
  std::vector<Angle> phis_;
  std::vector<double> radiances_;
  std::vector<double> ring_means_;  ///< of each row
};

}  // namespace gonio::reflectance
