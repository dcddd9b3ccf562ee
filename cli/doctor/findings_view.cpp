#include "cli/doctor/findings_view.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

namespace gonio::cli {

Table view(const std::vector<Finding>& findings) {
  Table table{.header = {"check", "verdict", "seen", "limit", "remedy"}, .rows = {}};
  for (const Finding& f : findings) {
    table.rows.push_back({f.check, std::string(verdict_name(f.verdict)), f.seen, f.limit, f.remedy});
  }
  return table;
}

std::string findings_json(const std::vector<Finding>& findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const Finding& f : findings) {
    list.push_back({{"check", f.check},
                    {"verdict", verdict_name(f.verdict)},
                    {"seen", f.seen},
                    {"limit", f.limit},
                    {"remedy", f.remedy}});
  }
  return list.dump();
}

void print_finding(std::ostream& out, const Finding& f) {
  constexpr int kIndent = 9;
  out << fmt::format("{:<{}}{}: {}{}\n", verdict_name(f.verdict), kIndent, f.check, f.seen,
                     f.limit.empty() ? "" : fmt::format(" ({})", f.limit));
  if (!f.remedy.empty()) out << fmt::format("{:{}}-> {}\n", "", kIndent, f.remedy);
  out << std::flush;
}

}  // namespace gonio::cli
