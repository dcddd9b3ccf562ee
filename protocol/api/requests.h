#pragma once

// What clients ask for, as values; the JSON bodies have the same names (json.h).
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace gonio::api {

/// A plan with the files it names. The daemon parses and never opens a client's path.
struct PlanSubmission {
  std::string plan;                          ///< TOML, verbatim
  std::string plan_file;                     ///< the user's name for it, shown in errors
  std::map<std::string, std::string> parts;  ///< name -> text
  int priority = 0;                          ///< -100 to 100; higher ones run first
  bool preempt = false;   ///< runs inside a scan of lower priority, which holds meanwhile and goes on by itself
  std::string start_utc;  ///< not before, as "2026-11-22T18:05Z"; empty: as soon as its turn has come
};

/// Where to move by hand; what is absent stays.
struct MoveRequest {
  std::optional<double> theta_i_deg;
  std::optional<double> theta_r_deg;
  std::optional<double> phi_r_deg;
  std::optional<double> phi_i_deg;
  std::optional<double> carriage_mm;
  std::optional<double> filter_wheel_slot;
  std::optional<bool> source_shutter_open;
  std::optional<bool> detector_shutter_open;
};

/// One reading by hand; shutters that it moves are put back.
struct DetectorReadRequest {
  std::optional<double> exposure_s;  ///< of a camera
  std::optional<double> range_w;     ///< of a radiometer
  std::optional<bool> lit;           ///< both shutters open, or the detector's closed; absent: as they stand
};

struct PauseRequest {
  bool now = false;  ///< true drops the item in hand
  std::string reason;
};

struct ResumeRequest {
  std::string hold;  ///< just this one; empty: all whose cause is not seen to stand
};

/// What is to change in the rest of a scan; what is absent stays.
struct ChangeRequest {
  std::optional<double> target_snr;
  std::optional<double> max_time_s;  ///< of one reading
  std::optional<std::string> order;  ///< of the points not begun: "as-written", "reversed", "random", "fastest"
  std::int64_t seed = 1;             ///< of "random"
  std::optional<int> priority;
  std::optional<std::string> start_utc;  ///< of a queued scan
  std::string reason;
};

struct AbortRequest {
  std::string reason;
};

/// A reference standard for the daemon's shelf, or to be looked at.
struct ReferenceImport {
  std::string text;        ///< reference/*.toml, the same without [shape], or a certificate as CSV
  std::string file;        ///< the user's name for it, shown in errors; ".csv" says what it is
  std::string shape;       ///< a shape table as CSV; empty: in the text, or `shape_of`
  std::string shape_file;  ///< likewise
  std::string shape_of;    ///< or the shape of this standard of the shelf
  bool replace = false;    ///< a standard of this serial number with another text
};

/// The body of a command that needs no words: `{}` or nothing.
struct NoWords {};

}  // namespace gonio::api
