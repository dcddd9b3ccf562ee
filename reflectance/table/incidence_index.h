#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "reflectance/direction/direction.h"
#include "reflectance/table/table_options.h"

namespace gonio::reflectance {

/// The measured incidences that an incidence lies between.
struct IncidenceBracket {
  struct Share {
    std::size_t row = 0;
    double weight = 0.0;
    bool is_absolute = false;  ///< the row's azimuths are phi_r itself: theta_i = 0 has no phi_i to count them from
  };
  std::array<Share, 4> share{};
  std::size_t size = 0;
  bool is_covered = true;
  double distance = 0.0;  ///< to the incidences it comes from, weighted as they are; 0 at one of them [rad]

  void add(const Share& s) { share[size++] = s; }
  [[nodiscard]] std::span<const Share> shares() const { return std::span(share).first(size); }
};

/// A row's incidence.
struct RowIncidence {
  Angle theta_i;
  Angle phi_i;
  std::size_t row = 0;
};

/// Finds the incidences next to one: linear in theta_i between two rings, and for an anisotropic surface linear in
/// phi_i, over 360 deg, along each of them. Beyond the outermost, that one alone. Immutable; threads: any.
class IncidenceIndex {
 public:
  /// Not empty. Thetas within options.same_direction share a ring.
  IncidenceIndex(std::span<const RowIncidence> rows, const TableOptions& options);
  [[nodiscard]] IncidenceBracket bracket(const Direction& i) const;

 private:
  struct Ring {
    double theta;
    std::vector<RowIncidence> rows;  ///< by phi_i
  };
  void add(IncidenceBracket& bracket, const Ring& ring, const Direction& i, double weight) const;

  std::vector<Ring> rings_;
  double tolerance_;
  double widest_step_;
  bool is_anisotropic_;
};

}  // namespace gonio::reflectance
