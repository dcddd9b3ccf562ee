#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "calibration/dark_history.h"

namespace gonio::calibration {

struct BackgroundVisit;

/// The background at a moment, and what it rests on.
struct BackgroundLevel {
  double level = 0.0;
  const BackgroundVisit* before = nullptr;  ///< one of the two may be missing: then it is the other's, unchanged
  const BackgroundVisit* after = nullptr;
  double weight_after = 0.0;  ///< of `after`; 1 - weight_after of `before`
};

/// What one visit found of light that does not come from the target, and what that rests on: a reading and its
/// background may rest on the same dark, which then cancels.
struct BackgroundVisit {
  std::int64_t visit_id = 0;
  Instant at{};
  double level = 0.0;
  double u = 0.0;                ///< of the level: its own noise
  std::vector<DarkShare> darks;  ///< d level / d dark
  double dq_dambient = 0.0;      ///< of a visit of the trap
  std::optional<BackgroundLevel> ambient;
};

/// Visits of one kind of background: the ambient light (source shutter closed; DN/s at 0 dB, or W) or the lamp's stray
/// light (black trap; in units of q), each by class of geometries. Threads: any, once filled.
class BackgroundHistory {
 public:
  void add(std::int32_t light_class, const BackgroundVisit& visit);
  /// After the last visit and before the first look.
  void sort();
  [[nodiscard]] bool is_empty() const { return visits_.empty(); }

  /// Linear in time between the two bracketing visits of the class; beyond the first or last, the nearest. Nothing for
  /// a class without visits. The pointers live as long as this object.
  [[nodiscard]] std::optional<BackgroundLevel> at(std::int32_t light_class, Instant when) const;

 private:
  std::map<std::int32_t, std::vector<BackgroundVisit>> visits_;  ///< in time order
};

}  // namespace gonio::calibration
