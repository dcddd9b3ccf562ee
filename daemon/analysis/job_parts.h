#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/analysis/job.h"
#include "daemon/analysis/picture.h"
#include "daemon/analysis/subject.h"
#include "daemon/analysis/told.h"

// What the jobs of this folder share; run_job alone calls the jobs themselves.
namespace gonio::analysis {

/// Each picture with its tables and script. `done` of the job lies before, the rest of it up to 1 is for these.
[[nodiscard]] Result<std::vector<api::AnalysisFile>> draw_all(const JobInput& input,
                                                              const std::vector<Picture>& pictures, double done,
                                                              Progress& progress);

/// Into the report what was found, `mark` behind the facts' names; into the folder texts and pictures, `stem` before
/// theirs. Errors: as write_file and draw.
[[nodiscard]] Result<void> take_told(const Told& told, const JobInput& input, const std::string& stem,
                                     const std::string& mark, api::AnalysisReport& report);

[[nodiscard]] Result<api::AnalysisReport> run_export(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_describe(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_plot(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_report(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_trace(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_readings(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_quantities(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_fit(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_symmetry(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_compare(const JobInput& input, Progress& progress);
[[nodiscard]] Result<api::AnalysisReport> run_repeatability(const JobInput& input, Progress& progress);

}  // namespace gonio::analysis
