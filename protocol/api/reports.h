#pragma once

// What the daemon answers, as values. Units stand in the names, as in the JSON of the same names (json.h).
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace gonio::api {

struct AxisReport {
  std::string name;       ///< "theta_i"
  std::string unit;       ///< "deg", "mm" or "slot"
  double position = 0.0;  ///< by the encoder, in that unit
  bool moving = false;
  bool homed = false;
  bool at_limit = false;
  int fault = 0;
};

/// The stage as last seen.
struct StageReport {
  double age_s = 0.0;  ///< since the stage said so
  bool moving = false;
  bool homed = false;
  bool halted = false;  ///< STOP stands: `stage reset` clears it
  bool heartbeat_tripped = false;
  bool interlock_open = false;
  int fault = 0;
  std::int64_t epoch = 0;
  std::int64_t boot_counter = 0;
  std::string source_shutter;  ///< "open", "closed", "moving"
  std::string detector_shutter;
  double monitor = 0.0;
  double lamp_temperature_c = 0.0;
  double detector_temperature_c = 0.0;
  double room_temperature_c = 0.0;
  double humidity_percent = 0.0;
  std::vector<AxisReport> axes;
};

/// Why a scan waits.
struct HoldReport {
  std::string name;
  std::string owner;
  std::string reason;
  double age_s = 0.0;
};

/// What idle time waited for: the store; wires (exchanges, looks that came late); devices (homing, ways back); holds;
/// the daemon itself.
struct IdleSplit {
  double commit_s = 0.0;
  double wire_s = 0.0;
  double device_s = 0.0;
  double hold_s = 0.0;
  double planning_s = 0.0;
};

/// Where time goes; a sum, or a mean for one point.
struct TimeSplit {
  double move_s = 0.0;
  double settle_s = 0.0;
  double expose_s = 0.0;
  double read_s = 0.0;
  double idle_s = 0.0;  ///< the sum of `idle_by`
  IdleSplit idle_by;
  [[nodiscard]] double total_s() const { return move_s + settle_s + expose_s + read_s + idle_s; }
};

struct ScanReport {
  std::int64_t id = 0;
  std::string name;
  std::string campaign;
  std::string sample;
  bool isotropic = true;
  std::string state;
  std::string outcome;  ///< why it ended
  std::string who;
  std::string reference;
  std::string instrument_sha256;
  std::string submitted_utc;
  std::string changed_utc;
  std::int64_t points = 0;  ///< blocked ones included
  std::int64_t merged = 0;
  std::int64_t blocked = 0;
  std::int64_t items = 0;  ///< sample and reference, of the points not blocked
  std::int64_t accepted = 0;
  std::int64_t skipped = 0;
  std::int64_t attempts = 0;
  std::int64_t visits = 0;
  std::int64_t reference_visits = 0;  ///< of them; likewise
  std::int64_t check_visits = 0;      ///< the rest are of the dark
  std::int64_t measured_again = 0;    ///< points, after a drift between two visits
  double largest_drift = 0.0;         ///< relative, between two visits of one kind
  TimeSplit spent;
  TimeSplit seconds_a_point;
  std::vector<HoldReport> holds;
  std::string doing;                        ///< while active: "exposing"
  std::optional<double> remaining_s;        ///< while active, from measured times
  std::optional<double> u_remaining_s;      ///< its standard uncertainty
  std::int64_t learned_from_scans = 0;      ///< while active: finished scans that the prediction rests on
  std::optional<std::int64_t> brdf_values;  ///< once computed
  std::optional<double> median_relative_u;  ///< of the expanded uncertainties U (k = 2 or by dof) over the value
  std::optional<double> worst_relative_u;
  int priority = 0;
  bool preempts = false;                          ///< runs inside a scan of lower priority
  std::optional<std::string> start_utc;           ///< not before
  std::optional<std::int64_t> queue_place;        ///< while queued: 1 is next, were all allowed to start
  std::int64_t completes = 0;                     ///< the scan whose missing points these are; 0: none
  std::int64_t completed_by = 0;                  ///< the newest scan made of its missing points; 0: none
  std::optional<std::string> calibrations;        ///< versions that its BRDF was computed with, once it was: "3 5"
  std::optional<std::string> plan;                ///< as it was sent; of one scan asked for, not in lists
  std::optional<std::string> plan_file;           ///< the user's name for it; likewise
  std::map<std::string, std::string> plan_parts;  ///< the files that the plan names, by name; likewise
  std::optional<std::string> checks;              ///< how its self-checks came out, once over; of one scan asked for
};

/// A scan waits for the lamp to be warm.
struct WarmUpReport {
  std::optional<double> slope_percent_per_min;  ///< of the lamp's monitor; none: not seen for long enough
  double limit_percent_per_min = 0.0;
  double waited_s = 0.0;
  double at_least_s = 0.0;  ///< still to be looked at before it can be judged
  double at_most_s = 0.0;   ///< until the scan holds
};

struct StatusReport {
  std::string version;
  std::string instrument;
  std::string instrument_sha256;
  double uptime_s = 0.0;
  std::string doing;
  bool stage_stopped = false;
  std::optional<ScanReport> active;
  std::vector<std::int64_t> queued;  ///< in the order of their turns
  std::vector<std::int64_t> aside;   ///< pre-empted: they go on when the active one is over
  std::optional<WarmUpReport> warm_up;
  std::optional<StageReport> stage;  ///< none before the first answer of the stage
  std::optional<Error> stage_error;
  std::optional<Error> detector_error;
  std::optional<Error> store_error;
  std::int64_t last_event = 0;
};

struct HealthReport {
  bool ok = false;
  std::string version;
};

/// How good a plan's order is.
struct PlanOrder {
  double walk_s = 0.0;        ///< one pass through the points: motion and settling, nothing in the way
  double bound_s = 0.0;       ///< no order has a shorter one
  std::string bound;          ///< "Held-Karp", or "two nearest" beyond 1000 points
  double as_written_s = 0.0;  ///< the whole scan in the order of the plan's text; 0: the arms cannot walk it
  double snaked_s = 0.0;      ///< the whole scan to and fro along the axes
};

/// What a plan's budget left of it. Points that are blocked do not count.
struct BudgetReport {
  double allowed_s = 0.0;
  double wished_s = 0.0;        ///< what the whole plan would take
  std::int64_t directions = 0;  ///< of the plan
  std::int64_t kept = 0;        ///< of them
  std::int64_t repeats = 0;     ///< of the plan, beyond the first time of each direction
  std::int64_t kept_repeats = 0;
  double target_snr = 0.0;      ///< of a reading, chosen
  double widest_gap_deg = 0.0;  ///< from a direction that was left out to the nearest kept one
};

/// What a plan's points would take and would be worth in one reference mode.
struct PlanMode {
  std::string mode;                ///< "same-geometry", "anchor", "absolute"
  double estimate_s = 0.0;         ///< of the scan
  double median_relative_u = 0.0;  ///< expected U / f, of a sample as white as the standard
  double worst_relative_u = 0.0;
  std::string dominant;                ///< the largest component at the worst point
  double mixed_share = 0.0;            ///< of the points, where neither spot nor field of view holds the other
  std::optional<std::string> refused;  ///< why the mode cannot be had; the figures are then 0
};

/// A dry run: what a plan would do on this instrument.
struct PlanReport {
  std::string name;
  std::string sample;
  std::string reference;
  int planner_version = 0;
  std::int64_t asked = 0;  ///< combinations in the plan's text
  std::int64_t points = 0;
  std::int64_t merged = 0;
  std::int64_t blocked = 0;
  std::int64_t items = 0;
  TimeSplit estimate;
  double estimate_s = 0.0;
  std::vector<std::int64_t> order;            ///< of the points, the first 1000
  std::int64_t out_of_reach = 0;              ///< of cones: left out
  std::vector<std::int64_t> without_partner;  ///< points whose reciprocal the arms do not reach, the first 1000
  PlanOrder walk;
  double u_estimate_s = 0.0;  ///< standard uncertainty
  std::int64_t visits = 0;    ///< of the dark, the standard and the sample
  std::int64_t disk_bytes = 0;
  double median_relative_u = 0.0;  ///< expected U / f (k = 2), of what is known before the sample is
  double worst_relative_u = 0.0;
  std::vector<double> relative_u;       ///< of the points in `order`
  std::int64_t learned_from_scans = 0;  ///< finished scans of this configuration that the time rests on
  std::optional<BudgetReport> budget;   ///< of a plan that has one
  std::string mode;                     ///< the plan's own
  std::vector<PlanMode> modes;          ///< all of them, beside each other
};

struct PointReport {
  std::int64_t index = 0;
  std::int64_t rank = 0;
  double theta_i_deg = 0.0;
  double phi_i_deg = 0.0;
  double theta_r_deg = 0.0;
  double phi_r_deg = 0.0;
  double wavelength_nm = 0.0;
  bool blocked = false;
  std::string sample;  ///< "accepted", "skipped", or empty while open
  std::string reference;
  std::int64_t attempts = 0;
};

/// One point of a result: a row of the export, or of GET brdf.
struct BrdfReport {
  std::int64_t point = 0;
  double theta_i_deg = 0.0;  ///< as reported by the encoders where measured, else as planned
  double phi_i_deg = 0.0;
  double theta_r_deg = 0.0;
  double phi_r_deg = 0.0;
  double wavelength_nm = 0.0;
  std::optional<double> brdf_per_sr;
  std::optional<double> u_random_per_sr;  ///< standard uncertainties
  std::optional<double> u_shared_per_sr;
  std::optional<double> u_own_per_sr;  ///< of what this scan drew anew: random, and its visits of the dark
  std::optional<double> u_per_sr;
  std::optional<double> k;  ///< coverage factor of 95.45 %, by the degrees of freedom
  std::optional<double> expanded_u_per_sr;
  std::optional<double>
      below_per_sr;  ///< the 95.45 % interval is [brdf - below, brdf + above]; U is the larger of both
  std::optional<double> above_per_sr;
  std::string status;  ///< "accepted", "blocked", "skipped", "refused", "unmeasured"
  std::string flags;   ///< words, separated by blanks
};

struct PointPage {
  std::vector<PointReport> points;
  std::optional<std::int64_t> next_after;  ///< ask with ?after= for more; none: this was the last page
};
struct BrdfPage {
  std::vector<BrdfReport> values;
  std::optional<std::int64_t> next_after;
};
struct ScanList {
  std::vector<ScanReport> scans;  ///< newest first
};

struct CertificateEntryReport {
  double wavelength_nm = 0.0;
  double reflectance = 0.0;
  double u = 0.0;  ///< absolute, k = 1
};

/// How wrong the shape may be, in one of its ways.
struct ShapeModeReport {
  std::string name;
  std::string kind;  ///< "limb", "forward", "sideways", "opposition"
  double u = 0.0;    ///< relative, k = 1
  std::optional<double> width_deg;
};

struct ReferenceReport {
  std::string serial;
  std::string material;
  std::string file;
  std::string certificate_date;
  std::string expires;
  std::optional<Error> error;  ///< why it cannot be used
  std::string geometry;        ///< of the certificate: "8/h", "h/8", "0/45"
  double from_nm = 0.0;        ///< where both certificate and shape hold
  double to_nm = 0.0;
  double last_theta_i_deg = 0.0;  ///< of the shape table
  double last_theta_r_deg = 0.0;
  std::string table;                  ///< "sound", "doubtful", "contradicts itself": its reciprocity and energy
  double largest_gap = 0.0;           ///< relative, between two exchanged directions of the table
  std::vector<std::string> findings;  ///< what is to be said of the table
  std::string note;                   ///< of an import: what became of it
  // Of one that was asked for; not in lists:
  double coverage_factor = 0.0;
  double correlation = 0.0;  ///< of the errors of any two entries
  double u_integral = 0.0;   ///< relative, k = 1
  std::vector<CertificateEntryReport> entries;
  std::vector<ShapeModeReport> modes;
  std::string text;  ///< the file
};
struct ReferenceList {
  std::vector<ReferenceReport> references;
};

/// What a committed change was, in the order of commitment.
struct Event {
  std::int64_t number = 0;  ///< gapless, from 1
  std::string kind;
  int kind_version = 1;
  std::int64_t scan = 0;
  std::string who;
  std::string utc;
  std::string data;  ///< a JSON object
};

struct StopReport {
  std::int64_t epoch = 0;  ///< commands decided before it are refused from now on
};

/// The answer to every other command.
struct CommandReport {
  std::int64_t scan = 0;  ///< concerned; 0: the stage
  bool existed = false;   ///< submission: this idempotency key was known; `scan` is the one it made then
  std::string note;       ///< what is to be known besides: holds that are left, the item skipped
};

}  // namespace gonio::api
