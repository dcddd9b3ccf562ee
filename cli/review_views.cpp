#include "cli/review_views.h"

#include <fmt/format.h>

#include <algorithm>

namespace gonio::cli {

Table view(const api::ScanChecksReport& report) {
  Table table{.header = {"check", "verdict", "compared", "chi_square", "degrees_of_freedom", "worst_z", "p_value"},
              .rows = {}};
  for (const api::ScanCheckReport& check : report.checks) {
    const bool has_sum = check.degrees_of_freedom > 0.0;
    const bool is_decided = check.compared > 0;
    table.rows.push_back(
        {check.name, check.verdict, std::to_string(check.compared), has_sum ? number_text(check.chi_square, 4) : "",
         has_sum ? number_text(check.degrees_of_freedom, 6) : "", is_decided ? number_text(check.worst_z, 3) : "",
         is_decided ? number_text(check.p_value, 2) : ""});
  }
  return table;
}

bool has_failed(const api::ScanChecksReport& report) {
  return std::ranges::any_of(report.checks, [](const api::ScanCheckReport& c) { return c.verdict == "failed"; });
}

Table budget_head(const api::PointBudgetReport& budget) {
  Table table{.header = {}, .rows = {{}}};
  const auto add = [&](std::string name, std::string value) {
    table.header.push_back(std::move(name));
    table.rows[0].push_back(std::move(value));
  };
  add("scan", std::to_string(budget.scan));
  add("point", fmt::format("{} ({})", budget.point, budget.chosen));
  add("directions_deg", fmt::format("theta_i {:.3f}, phi_i {:.3f}, theta_r {:.3f}, phi_r {:.3f}", budget.theta_i_deg,
                                    budget.phi_i_deg, budget.theta_r_deg, budget.phi_r_deg));
  add("wavelength_nm", number_text(budget.wavelength_nm));
  add("f_r_per_sr", number_text(budget.brdf_per_sr));
  add("u_per_sr", fmt::format("{:.3g} (random {:.3g}, shared {:.3g}; k = 1)", budget.u_per_sr, budget.u_random_per_sr,
                              budget.u_shared_per_sr));
  add("degrees_of_freedom", budget.degrees_of_freedom ? number_text(*budget.degrees_of_freedom, 4) : "infinite");
  add("U_per_sr", fmt::format("{:.3g} (k = {:.2f}, 95.45 %)", budget.expanded_u_per_sr, budget.k));
  add("interval_per_sr", fmt::format("{:.6g} to {:.6g}", budget.brdf_per_sr - budget.below_per_sr,
                                     budget.brdf_per_sr + budget.above_per_sr));
  add("method", budget.method);
  add("flags", budget.flags);
  return table;
}

Table view(const api::PointBudgetReport& budget) {
  Table table{.header = {"component", "kind", "distribution", "u", "unit", "sensitivity_per_sr", "contribution_per_sr",
                         "share_percent", "degrees_of_freedom"},
              .rows = {}};
  for (const api::BudgetTermReport& term : budget.terms) {
    table.rows.push_back({term.component, term.kind, term.distribution, number_text(term.u, 3), term.unit,
                          number_text(term.sensitivity, 3), number_text(term.contribution_per_sr, 3),
                          fmt::format("{:.2f}", term.share_percent),
                          term.degrees_of_freedom ? number_text(*term.degrees_of_freedom, 3) : "inf"});
  }
  return table;
}

}  // namespace gonio::cli
