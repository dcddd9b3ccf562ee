#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// Visits of the standard, or of the sample, at one point of a scan that wants them.
struct VisitTrack {
  std::int32_t at = 0;              ///< the point
  std::optional<VisitLevel> level;  ///< of the last one, of any run
  std::vector<ItemKey> since;       ///< accepted after it, in force: the next one judges them
  std::optional<Instant> last;      ///< of this run
  std::optional<std::size_t> rung;  ///< that the first one of this run chose: all of them expose alike
};

/// Visits of the standard: at one point, or in anchor mode at one for each wavelength, which are then visited in turn.
/// A visit judges what was measured at its own wavelength; at one point alone, everything.
class ReferenceTracks {
 public:
  /// `at`: at least one point. What the store knows of the last visit belongs to the point where that was.
  ReferenceTracks(const std::vector<std::int32_t>& at, LastVisit stored, const std::vector<ScanPoint>& points);

  /// The one whose visit lies longest ago in this run.
  [[nodiscard]] const VisitTrack& due() const;
  /// The one at this point; it has one (asserted).
  [[nodiscard]] VisitTrack& at(std::int32_t point);
  /// When the one that is due was visited.
  [[nodiscard]] std::optional<Instant> last() const { return due().last; }
  /// Items were accepted after the last visit of their own.
  [[nodiscard]] bool is_owed() const;
  /// Of the first point: where the sample is checked too.
  [[nodiscard]] const std::optional<VisitLevel>& level() const { return tracks_.front().level; }

  void note(const ItemKey& item, const std::vector<ScanPoint>& points);
  void forget(const ItemKey& item);

 private:
  [[nodiscard]] VisitTrack& track_of(const ItemKey& item, const std::vector<ScanPoint>& points);
  std::vector<VisitTrack> tracks_;
};

}  // namespace gonio::daemon
