#pragma once

// Jobs of the worker program: exports, plots, reports, traces. Units stand in the names, as in the JSON (json.h).
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace gonio::api {

/// What the worker program can be asked for.
inline constexpr std::array<std::string_view, 11> kAnalysisKinds{"export",   "describe",      "plot",    "report",
                                                                 "trace",    "quantities",    "fit",     "compare",
                                                                 "symmetry", "repeatability", "readings"};
/// Formats of an export. "csv+json" is our own, which loses nothing.
inline constexpr std::array<std::string_view, 10> kExportFormats{"csv+json", "bird", "astm",  "zemax", "merl",
                                                                 "ssdd",     "pab",  "klems", "rgl",   "nexus"};

/// One job. What its kind does not need is left out.
struct AnalysisRequest {
  std::string kind;                   ///< one of kAnalysisKinds
  std::int64_t scan = 0;              ///< whose result
  std::string format;                 ///< export: one of kExportFormats
  std::optional<std::int64_t> point;  ///< trace
  std::int64_t other_scan = 0;        ///< compare: with this scan, or with
  std::string other_model;  ///< a model by its numbers ("rpv rho0=0.133 k=0.851 g=-0.114"), or fitted ("rpv"), or with
  std::string other_file;   ///< a BRDF file of this name, any format that is read: its bytes come along,
  std::string other_bytes;  ///< in base64 (RFC 4648), for the daemon opens no client's path
  std::vector<std::int64_t> others;  ///< repeatability: scans beside the first; none: its campaign's, of its sample
  std::string model;          ///< fit: "rpv", "lambertian + ggx", several with commas between; empty: the usual ones
  double deadline_s = 600.0;  ///< up to 3600: the job is ended then
};

/// What a file does not hold of what was measured.
struct AnalysisLoss {
  std::string kind;         ///< "uncertainty", "resampled"
  std::int64_t values = 0;  ///< how many are concerned; 0: the file as a whole
  std::string what;
};

struct AnalysisFile {
  std::string name;  ///< ask for it by this one
  std::int64_t bytes = 0;
};

/// A number that a job found.
struct AnalysisFact {
  std::string name;
  double value = 0.0;
  std::optional<double> expanded_u;  ///< for a level of confidence of 95.45 %
  std::string unit;                  ///< "sr^-1"; "1" for none
  std::string note;
};

struct AnalysisReport {
  std::int64_t id = 0;
  std::string kind;
  std::int64_t scan = 0;  ///< 0: of a file
  std::string state;      ///< "queued", "running", "done", "failed", "cancelled"
  std::string who;
  double progress = 0.0;  ///< 0 to 1
  std::string doing;      ///< the step in hand, or the last one
  std::string submitted_utc;
  std::string ended_utc;       ///< empty before
  std::optional<Error> error;  ///< why it failed
  std::vector<AnalysisFile> files;
  std::vector<AnalysisLoss> losses;
  std::vector<AnalysisFact> facts;
  std::vector<std::string> notes;  ///< what is to be known besides
};
struct AnalysisList {
  std::vector<AnalysisReport> jobs;  ///< newest first
};

}  // namespace gonio::api
