#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// A row of `reading`, as the wire said it.
struct TracedReading {
  std::int64_t reading = 0;  ///< reading_id
  int sequence = 0;
  bool used = true;  ///< false: a probe, or saturated
  std::int64_t pixels = 0;
  double mean_dn = 0.0;
  double m2_dn2 = 0.0;
  double m3_dn3 = 0.0;
  double m4_dn4 = 0.0;
  std::int64_t saturated = 0;
  double exposure_s = 0.0;
  double gain_db = 0.0;
  double monitor_mean = 0.0;
  double monitor_se = 0.0;
  std::optional<double> power_w;  ///< of a radiometer: its mean
  std::string utc;
};

/// A try at an item, with all that it read.
struct TracedAttempt {
  std::int64_t attempt = 0;  ///< attempt_id
  std::string target;        ///< "sample", "reference"
  int number = 0;
  std::string outcome;  ///< "accepted", "failed", "dropped"
  std::string error;
  bool in_force = false;  ///< the value rests on this one
  int round = 0;          ///< of its acceptance; 0: not accepted
  std::string utc;
  std::vector<TracedReading> readings;
};

struct TracedVisit {
  std::int64_t visit = 0;  ///< visit_id
  std::string kind;
  std::string utc;
  std::vector<TracedReading> readings;
};

/// Everything raw that is behind a point.
struct PointTrace {
  std::vector<TracedAttempt> attempts;  ///< both targets, in the order of their commits
  /// For each accepted attempt the last visit of the dark before it and the first after it, each once, in order.
  std::vector<TracedVisit> darks;
};

/// Reads the store beside its writer. Errors: StoreFailed, StoreTooNew. A point that there is not has an empty trace.
[[nodiscard]] Result<PointTrace> trace_point(const std::string& store_file, ScanId scan, std::int32_t point);

}  // namespace gonio::daemon
