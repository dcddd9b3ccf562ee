#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/geometry.h"
#include "base/large_array.h"
#include "base/units.h"
#include "calibration/budget.h"
#include "calibration/term_store.h"

namespace gonio::calibration {

/// What a reader of a value should know beside its uncertainty. Bits of CalibratedPoint::flags; never renumbered.
enum class PointFlag : std::uint32_t {
  NearZero = 1U << 0U,           ///< |f| <= U: not told from zero; the sign is kept
  DarkExtrapolated = 1U << 1U,   ///< no dark after (or before) the sample's or the reference's reading
  FewNeighbours = 1U << 2U,      ///< the slope along an angle was guessed: no other point on that line
  BorrowedReference = 1U << 3U,  ///< the reference was read for another point of the same geometry
  UncertainDivisor = 1U << 4U,   ///< relative u of the reference's reading, its darks and visits, above 5 %
  Drifted = 1U << 5U,            ///< read between two visits of the standard that differ by more than the plan's limit
  InstrumentLimited = 1U << 6U,  ///< f_r bends within the cones of source and detector: a lobe about as narrow as they
  MonteCarlo = 1U << 7U,         ///< u and U by Monte Carlo (JCGM 101), for the formula does not hold
  FewRepeats = 1U << 8U,         ///< fewer than 10 effective degrees of freedom: k is Student's
  Mixed = 1U << 9U,              ///< neither spot nor field of view holds the other: by the overlap of both
  ReferenceExtrapolated = 1U << 10U,  ///< somewhat beyond the shape table's last entry: its edge is held
  Blocked = 1U << 11U,                ///< one arm's head stands in the other's light
  Saturated = 1U << 12U,              ///< some exposures of the reading were saturated and left out
};
[[nodiscard]] std::string_view flag_name(PointFlag flag);
[[nodiscard]] constexpr bool has(std::uint32_t flags, PointFlag flag) {
  return (flags & static_cast<std::uint32_t>(flag)) != 0;
}

/// The BRDF of one point.
struct CalibratedPoint {
  std::int32_t point_index = 0;
  Geometry geometry;  ///< reported: the sample's encoders over its exposures
  Wavelength wavelength;
  Brdf value;  ///< signed
  Budget budget;
  std::uint32_t flags = 0;
  std::int64_t sample_reading = 0;  ///< RawReading::id
  std::int64_t reference_reading = 0;
};

/// A point without a value, and why.
struct RefusedPoint {
  std::int32_t point_index = 0;
  Error reason;
};

struct ScanSummary {
  std::size_t points = 0;  ///< with a value
  std::size_t refused = 0;
  std::size_t near_zero = 0;
  double median_relative_expanded = 0.0;  ///< U/|f| of the points that are not near zero; 0 without any
  double worst_relative_expanded = 0.0;
  Brdf median_expanded;  ///< of all points with a value
  double frame_chi2_per_dof =
      0.0;  ///< of repeated frames about their means by the noise model: 1 when it is true; 0 without repeats
  friend bool operator==(const ScanSummary&, const ScanSummary&) = default;
};

/// What readings, instrument and standard make of a scan.
struct CalibratedScan {
  std::vector<Component> components;                    ///< what the budgets' terms count in
  std::shared_ptr<const std::vector<TermStore>> terms;  ///< the budgets' own; copies of the scan share them
  LargeArray<CalibratedPoint> points;                   ///< in the order of the planned points
  std::vector<RefusedPoint> refused;                    ///< likewise; points without a sample reading stand in neither
  ScanSummary summary;
};

}  // namespace gonio::calibration
