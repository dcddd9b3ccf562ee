#pragma once

#include <string>
#include <vector>

#include "daemon/analysis/budget_summary.h"
#include "daemon/analysis/stored_scan.h"
#include "daemon/store/scan_history.h"
#include "protocol/api/analysis.h"
#include "protocol/api/scan_review.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::analysis {

struct ReportPicture {
  std::string caption;
  std::string svg;
};

/// What a report is made of. All of it is in the store, or was computed from it.
struct ReportParts {
  const StoredScan& scan;
  const formats::MeasuredBrdf& brdf;
  const daemon::ScanHistory& history;
  std::vector<BudgetLine> budget;
  std::vector<api::AnalysisFact> facts;  ///< integrals and cross-validation
  api::ScanChecksReport checks;
  std::vector<api::AnalysisFact> fit;  ///< the best of the usual models, by channel; empty: none could be fitted
  std::vector<std::string> fit_notes;
  std::vector<ReportPicture> pictures;
  std::vector<std::string> notes;
  std::string made_utc;
};

/// One self-contained page, which prints well: what a lab signs. Each number has a command beside it that leads down to
/// raw readings.
[[nodiscard]] std::string report_page(const ReportParts& parts);

/// "0.133 ± 0.0007 sr<sup>-1</sup>", with its unit unless that is 1; HTML.
[[nodiscard]] std::string fact_value(const api::AnalysisFact& fact);
/// The command that leads from a point down to raw readings; HTML.
[[nodiscard]] std::string trace_command(const StoredScan& scan, std::int64_t point);

// Its sections, in their order.
[[nodiscard]] std::string summary_section(const ReportParts& parts);
[[nodiscard]] std::string sample_section(const ReportParts& parts);
[[nodiscard]] std::string chain_section(const ReportParts& parts);
[[nodiscard]] std::string budget_section(const ReportParts& parts);
[[nodiscard]] std::string checks_section(const ReportParts& parts);
[[nodiscard]] std::string fit_section(const ReportParts& parts);
[[nodiscard]] std::string environment_section(const ReportParts& parts);
[[nodiscard]] std::string values_section(const ReportParts& parts);
[[nodiscard]] std::string gaps_section(const ReportParts& parts);
[[nodiscard]] std::string people_section(const ReportParts& parts);
[[nodiscard]] std::string origins_section(const ReportParts& parts);

}  // namespace gonio::analysis
