#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/geometry.h"
#include "base/result.h"
#include "base/units.h"
#include "protocol/api/plan_calibration.h"
#include "protocol/api/plan_part.h"

namespace gonio::api {

enum class OrderStrategy : std::uint8_t { Fastest, AsWritten, Random };
enum class OnItemError : std::uint8_t { Skip, Hold, Fail };
enum class OnRestart : std::uint8_t { Resume, Hold };
/// What a sample's reading is compared with (calibration/raw_reading.h).
enum class ReferenceMode : std::uint8_t {
  SameGeometry,  ///< the standard at the same directions
  Anchor,        ///< the standard at one geometry
  Absolute,      ///< the direct beam, as a calibration has measured it
};

/// [budget]: what a scan may take at most. The planner chooses how to use it best.
struct PlanBudget {
  Duration time{};
  /// A reading's signal-to-noise may come down to this before anything is left out; none: it stays at target_snr.
  std::optional<double> least_snr;
};

/// A plan as its author wrote it, checked for form (names, units, ranges of single values) but not yet for the
/// instrument: limits, blocked geometries and the reference's reach are the planner's. The points are those of the
/// product of the lists, theta_i slowest (none when theta_r is empty), then those of the parts.
struct Plan {
  std::string name;
  std::string sample;
  bool isotropic = true;  ///< [scan] isotropic, default true: phi_r counts from phi_i, theta = 0 merges all phi
  /// [scan] expected_reflectance: about how large the sample's reflectance factor is; none: not known. What a dry run
  /// says rests on it, never a result.
  std::optional<double> expected_reflectance;
  std::vector<Angle> theta_i;
  std::vector<Angle> phi_i;  ///< default {0}
  std::vector<Angle> theta_r;
  std::vector<Angle> phi_r;
  std::vector<Wavelength> wavelengths;
  int repeats = 1;  ///< of each point of the product
  std::vector<PlanPart> parts;
  /// Adds to each point the one with source and detector exchanged, where the arms can come to it.
  bool is_reciprocal = false;
  std::optional<bool> relative_azimuth;  ///< whether phi_r counts from phi_i; none: if the sample is isotropic
  double target_snr = 300.0;             ///< of one reading
  Duration max_time{};                   ///< of one reading, exposure times frames
  /// [reading] exposure_s, ascending: one is fixed, several bracket; empty: chosen. Of a linearity job up and down
  /// again.
  std::vector<Duration> exposures;
  std::string reference_standard;  ///< serial number
  ReferenceMode reference_mode = ReferenceMode::SameGeometry;
  /// Where the standard is read in anchor mode; phi_i is 0. A point of the scan: added where the plan has it not.
  Geometry anchor{.theta_i = {}, .phi_i = {}, .theta_r = degrees(45.0), .phi_r = {}};
  Duration block{};            ///< sample items and their reference partners lie within this time
  Duration dark_every{};       ///< visits
  Duration reference_every{};  ///< visits of the standard at one geometry; zero: none. In anchor mode never none
  Duration check_every{};      ///< of the sample likewise
  double drift_limit = 0.005;  ///< relative, between two visits: beyond it the points between are measured again
  int drift_rounds = 2;        ///< how often at most
  OrderStrategy order = OrderStrategy::Fastest;
  std::uint64_t order_seed = 1;
  int item_retries = 2;  ///< on_error.item = "retry N, then skip|hold|fail"
  OnItemError on_item_error = OnItemError::Skip;
  OnRestart on_restart = OnRestart::Resume;
  std::optional<PlanCalibration> calibration;  ///< the job that this scan is measured for
  std::optional<PlanBudget> budget;            ///< none: everything is measured
};

/// Errors: InvalidInput, UnknownKey, MissingKey, with file, line, field and nearest name. `file` is the user's name for
/// it; `files` the texts of the files that it names, by name.
[[nodiscard]] Result<Plan> parse_plan(std::string_view toml, const std::string& file,
                                      const std::map<std::string, std::string>& files = {});

}  // namespace gonio::api
