#pragma once

// What calibration jobs have found, and what is asked of it. Units stand beside the values, for each job has its own.
#include <cstdint>
#include <string>
#include <vector>

namespace gonio::api {

struct FoundValueReport {
  std::string name;  ///< "zero_theta_i_deg"
  std::string unit;
  double value = 0.0;
  double u = 0.0;  ///< standard uncertainty
};

/// A change of what counts.
struct CalibrationUseReport {
  std::string utc;
  std::string who;
  bool in_use = false;
  std::string reason;
};

/// One version: what one job has found.
struct CalibrationReport {
  std::int64_t version = 0;
  std::string job;
  std::int64_t scan = 0;  ///< the job's
  std::string sample;     ///< of that scan: the mirror, the check standard
  bool counts = false;    ///< scans that are computed now take it
  std::string utc;
  std::string code_version;
  std::string note;  ///< how it fitted, what it could not see
  std::vector<FoundValueReport> values;
  std::vector<double> covariance;  ///< of the values, row by row
  std::string inputs;              ///< a JSON object: the scan, its readings, hashes
  std::vector<CalibrationUseReport> uses;
};
struct CalibrationList {
  std::vector<CalibrationReport> calibrations;  ///< newest first
};

/// One run of a check standard.
struct ChartPointReport {
  std::int64_t scan = 0;
  std::int64_t version = 0;
  std::string utc;
  double value = 0.0;
  double u = 0.0;          ///< of what each run draws anew
  double deviation = 0.0;  ///< from the centre, in standard deviations of the chart; 0 while there is no centre
  std::string broken;      ///< the rules that this run breaks, in words; empty: none
};
struct ChartReport {
  std::string standard;
  std::string quantity;
  std::int64_t baseline = 0;  ///< runs that centre and limits come from; 0: too few runs yet
  double centre = 0.0;
  double sd = 0.0;
  double low = 0.0;  ///< control limits, three standard deviations
  double high = 0.0;
  std::string verdict;
  std::vector<ChartPointReport> points;  ///< oldest first
};

struct UseCalibrationRequest {
  bool in_use = true;  ///< false: it counts no more
  std::string reason;
};

struct RecomputeRequest {
  std::string calibration;  ///< versions, separated by blanks; "none": instrument.toml alone; empty: those that count
};

}  // namespace gonio::api
