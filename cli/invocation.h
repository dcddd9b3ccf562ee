#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "cli/output.h"
#include "cli/replay_program.h"
#include "protocol/api/calibration_reports.h"
#include "protocol/api/requests.h"

namespace gonio::cli {

enum class Verb : std::uint8_t {
  Status,
  Stop,
  StageShow,
  StageMove,
  StageHome,
  StageReset,
  PlanCheck,
  ScanRun,
  ScanList,
  ScanShow,
  ScanWatch,
  ScanPause,
  ScanResume,
  ScanFinish,
  ScanAbort,
  ScanSkip,
  ScanChange,
  ScanCompleteMissing,
  ScanCompare,
  ScanRepeat,
  Replay,
  DataExport,
  DataTrace,
  DataQuantities,
  DataFit,
  DataCompare,
  DataSymmetry,
  DataRepeatability,
  DataReadings,
  DataPlot,
  DataReport,
  DataDescribe,
  DataConvert,
  DataImport,
  DataJobs,
  DataCancel,
  ReferenceList,
  Instrument,
  Doctor,
  Events,
  DetectorRead,
  CalibrationList,
  CalibrationShow,
  CalibrationUse,
  CalibrationChart,
  CalibrationCertificate,
  CalibrationMaps,
  ScanRecompute,
  ReferenceShow,
  ReferenceCheck,
  ReferenceImport,
  DataCheck,
  DataBudget,
};

/// What the command line asks for.
struct Invocation {
  Verb verb = Verb::Status;
  std::string connect;
  Format format = Format::Table;
  std::int64_t scan = 0;
  std::int64_t other_scan = 0;  ///< to compare with
  ReplayLine replay;
  std::string file;  ///< a plan, or where an export goes ("-": standard output)
  std::string export_format = "csv";
  std::string input;                 ///< a BRDF file
  std::string other;                 ///< data compare: a scan's number, a BRDF file, or a model
  std::vector<std::int64_t> others;  ///< data repeatability
  std::string result;                ///< where results go; empty: here, under their own names
  std::string model;                 ///< to be fitted; empty: the usual ones
  std::int64_t job = 0;              ///< of the worker program
  std::int64_t point = 0;            ///< to be traced
  bool watch = false;
  bool now = false;        ///< pause
  bool follow = false;     ///< events
  bool move = false;       ///< doctor
  std::int64_t after = 0;  ///< events
  std::string reason;
  std::string hold;                ///< resume: just this one
  int priority = 0;                ///< run
  bool preempt = false;            ///< run
  std::string start_utc;           ///< run: not before
  api::ChangeRequest change;       ///< of a scan's rest
  std::int64_t budget_point = -1;  ///< -1: the one of median U
  std::string serial;              ///< reference show
  std::string shape_file;          ///< reference import, check: a shape as CSV
  std::string shape_of;            ///< likewise: a standard of the shelf
  bool replace = false;            ///< reference import
  std::string key;                 ///< Idempotency-Key; empty: a new one
  api::MoveRequest target;         ///< of a move by hand
  api::DetectorReadRequest reading;
  api::UseCalibrationRequest use;
  api::RecomputeRequest recompute;
  std::string standard;         ///< of a chart
  std::string expires;          ///< of a certificate: a date
  double longest_gap_nm = 1.0;  ///< likewise
};

/// Something to be printed instead: help or version (to standard output, exit code 0), or why the line is wrong (2).
struct Advice {
  std::string text;
  int exit_code = 0;
};

/// Reads the arguments after the program's name. `default_connect`: of the environment, or the usual address.
[[nodiscard]] tl::expected<Invocation, Advice> read_command_line(const std::vector<std::string>& arguments,
                                                                 const std::string& default_connect);

}  // namespace gonio::cli
