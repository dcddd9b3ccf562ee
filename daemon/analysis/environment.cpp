#include "daemon/analysis/environment.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <fmt/format.h>

namespace gonio::analysis {
namespace {

using daemon::HistoryReading;

struct Latched {
  const char* name;
  const char* unit;
  double HistoryReading::*value;
};
constexpr std::array<Latched, 5> kLatched{{{"lamp", "degC", &HistoryReading::lamp_temperature_c},
                                           {"detector", "degC", &HistoryReading::detector_temperature_c},
                                           {"room", "degC", &HistoryReading::room_temperature_c},
                                           {"humidity", "%", &HistoryReading::humidity_percent},
                                           {"lamp monitor", "1", &HistoryReading::monitor_mean}}};

std::string number_or_none(const std::optional<std::int64_t>& number) {
  return number ? std::to_string(*number) : "";
}

}  // namespace

std::vector<api::AnalysisFact> environment_facts(const std::vector<HistoryReading>& readings) {
  std::vector<api::AnalysisFact> facts;
  std::map<std::string, int> kinds;
  for (const HistoryReading& r : readings) ++kinds[r.of];
  for (const auto& [kind, count] : kinds) {
    facts.push_back({.name = "readings, " + kind, .value = static_cast<double>(count), .unit = "1", .note = ""});
  }
  if (readings.empty()) return facts;
  for (const Latched& latched : kLatched) {
    const auto [least, most] = std::ranges::minmax_element(readings, {}, latched.value);
    const std::string name = latched.name;
    facts.push_back({.name = name + ", least",
                     .value = (*least).*latched.value,
                     .unit = latched.unit,
                     .note = fmt::format("reading {}", least->reading)});
    facts.push_back({.name = name + ", largest",
                     .value = (*most).*latched.value,
                     .unit = latched.unit,
                     .note = fmt::format("reading {}", most->reading)});
  }
  return facts;
}

std::string readings_table(const std::vector<HistoryReading>& readings) {
  std::string table =
      "reading,attempt,visit,of,utc,exposure_s,mean_dn,monitor_mean,lamp_c,detector_c,room_c,humidity_percent\n";
  for (const HistoryReading& r : readings) {
    table += fmt::format("{},{},{},{},{},{:.9g},{:.17g},{:.17g},{:.6g},{:.6g},{:.6g},{:.6g}\n", r.reading,
                         number_or_none(r.attempt), number_or_none(r.visit), r.of, iso8601(r.at), r.exposure_s,
                         r.mean_dn, r.monitor_mean, r.lamp_temperature_c, r.detector_temperature_c,
                         r.room_temperature_c, r.humidity_percent);
  }
  return table;
}

}  // namespace gonio::analysis
