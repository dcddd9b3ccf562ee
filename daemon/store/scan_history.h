#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// What was latched with one exposure, beside the light.
struct HistoryReading {
  std::int64_t reading = 0;             ///< reading_id
  std::optional<std::int64_t> attempt;  ///< attempt_id, of an item's reading
  std::optional<std::int64_t> visit;    ///< visit_id, of a visit's
  std::string of;                       ///< "sample", "reference", or the visit's kind: "dark", "check"
  UtcTime at{};
  bool is_dark = false;
  double exposure_s = 0.0;
  double mean_dn = 0.0;
  double monitor_mean = 0.0;
  double lamp_temperature_c = 0.0;
  double detector_temperature_c = 0.0;
  double room_temperature_c = 0.0;
  double humidity_percent = 0.0;
};

struct HistoryVisit {
  UtcTime at{};
  std::string kind;
  double level = 0.0;  ///< as visit_level has it
  double u_relative = 0.0;
  std::optional<double> drift;
};

/// A step of a scan's life that somebody or something took.
struct HistoryStep {
  UtcTime at{};
  std::string kind;
  std::string who;
  std::string json;
};

/// A scan's course in time.
struct ScanHistory {
  std::vector<HistoryReading> readings;  ///< used ones, in the order of their rows
  std::vector<HistoryVisit> visits;      ///< lit ones
  std::vector<HistoryStep> steps;        ///< events but those of items
};

/// Reads the store beside its writer. Errors: StoreFailed, StoreTooNew.
[[nodiscard]] Result<ScanHistory> scan_history(const std::string& store_file, ScanId scan);

}  // namespace gonio::daemon
