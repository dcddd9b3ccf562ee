#include "daemon/store/past_scans.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace gonio::daemon {

namespace {

constexpr std::int64_t kMostScans = 20;      // the last ones: a stage ages
constexpr std::int64_t kMostWhiteScans = 3;  // a lamp does so faster
constexpr std::int64_t kReadingsOfAScan = 200;

struct PastScan {
  std::int64_t id = 0;
  double motion_ratio = 1.0;
  double beyond_s = 0.0;
};

std::vector<PastScan> past_scans(Database& database, const std::string& configuration_hash) {
  Statement& query = database.statement(
      "SELECT s.scan_id, p.motion_ns / p.motion_ratio, "
      "json_extract(e.json, '$.time.move_s') + json_extract(e.json, '$.time.settle_s'), "
      "json_extract(e.json, '$.time.read_s') + json_extract(e.json, '$.time.idle_by.commit_s') + "
      "json_extract(e.json, '$.time.idle_by.wire_s') + json_extract(e.json, '$.time.idle_by.planning_s'), "
      "json_extract(e.json, '$.accepted') "
      "FROM scan s JOIN prediction p USING (scan_id) JOIN event e ON e.scan_id = s.scan_id AND e.kind = 'scan-done' "
      "WHERE s.state = 'done' AND s.configuration_hash = ? ORDER BY s.scan_id DESC LIMIT ?");
  query.bind(configuration_hash).bind(kMostScans);
  std::vector<PastScan> scans;
  while (query.next()) {
    constexpr double kNanosecond = 1e-9;
    const double predicted_s = kNanosecond * query.real(1);
    const std::int64_t accepted = query.integer(4);
    if (predicted_s <= 0.0 || accepted <= 0 || query.is_null(2) || query.is_null(3)) continue;
    scans.push_back({query.integer(0), query.real(2) / predicted_s, query.real(3) / static_cast<double>(accepted)});
  }
  return scans;
}

// Of the next one: the scatter of those before, and that of their mean. One alone is doubted as much as the guess was.
Learned learned(const std::vector<PastScan>& scans, double PastScan::*what, double doubt) {
  const auto n = static_cast<double>(scans.size());
  double mean = 0.0;
  for (const PastScan& scan : scans) mean += scan.*what / n;
  if (scans.size() < 2) return {mean, doubt};
  double squares = 0.0;
  for (const PastScan& scan : scans) squares += (scan.*what - mean) * (scan.*what - mean);
  return {mean, std::sqrt(squares / (n - 1.0) * (1.0 + 1.0 / n))};
}

std::map<std::int64_t, double> dark_levels(Database& database, std::int64_t scan) {
  Statement& query = database.statement(
      "SELECT r.exposure_ns, avg(r.mean_dn) FROM visit v JOIN reading r USING (visit_id) "
      "WHERE v.scan_id = ? AND v.kind = 'dark' GROUP BY r.exposure_ns");
  query.bind(scan);
  std::map<std::int64_t, double> levels;
  while (query.next()) levels[query.integer(0)] = query.real(1);
  return levels;
}

struct Mean {
  double sum = 0.0;
  std::int64_t n = 0;
};

void add_white(Database& database, std::int64_t scan, std::map<double, Mean>& by_wavelength) {
  const std::map<std::int64_t, double> darks = dark_levels(database, scan);
  Statement& query = database.statement(
      "SELECT p.wavelength_nm, p.theta_i_deg, r.mean_dn, r.exposure_ns FROM decided_item i "
      "JOIN reading r USING (attempt_id) JOIN point p ON p.scan_id = i.scan_id AND p.point_index = i.point_index "
      "WHERE i.scan_id = ? AND i.target = 'reference' AND i.outcome = 'accepted' AND r.used = 1 LIMIT ?");
  query.bind(scan).bind(kReadingsOfAScan);
  while (query.next()) {
    const auto dark = darks.find(query.integer(3));
    const double cosine = std::cos(query.real(1) * std::numbers::pi / 180.0);
    const double exposure_s = 1e-9 * static_cast<double>(query.integer(3));
    if (dark == darks.end() || cosine <= 0.0 || exposure_s <= 0.0) continue;
    Mean& mean = by_wavelength[query.real(0)];
    mean.sum += (query.real(2) - dark->second) / exposure_s / cosine;
    ++mean.n;
  }
}

}  // namespace

TimeExperience read_experience(Database& database, const std::string& configuration_hash) {
  TimeExperience experience;
  const std::vector<PastScan> scans = past_scans(database, configuration_hash);
  if (scans.empty()) return experience;
  experience.scans = static_cast<std::int64_t>(scans.size());
  experience.motion = learned(scans, &PastScan::motion_ratio, experience.motion.u);
  experience.beyond_s = learned(scans, &PastScan::beyond_s, experience.beyond_s.u);
  std::map<double, Mean> white;
  for (std::size_t k = 0; k < scans.size() && k < kMostWhiteScans; ++k) add_white(database, scans[k].id, white);
  for (const auto& [wavelength_nm, mean] : white) {
    experience.white.push_back({nanometres(wavelength_nm), mean.sum / static_cast<double>(mean.n)});
  }
  return experience;
}

}  // namespace gonio::daemon
