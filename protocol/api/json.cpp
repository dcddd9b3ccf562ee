#include "protocol/api/json.h"

#include <nlohmann/json.hpp>

namespace nlohmann {

// Absent and null are the same.
template <class T>
struct adl_serializer<std::optional<T>> {
  static void to_json(json& j, const std::optional<T>& value) {
    if (value) {
      j = *value;
    } else {
      j = nullptr;
    }
  }
  static void from_json(const json& j, std::optional<T>& value) {
    if (j.is_null()) {
      value.reset();
    } else {
      value = j.get<T>();
    }
  }
};

}  // namespace nlohmann

namespace gonio {

// As problem+json (RFC 9457): type, title, status, detail; the rest are the members of the error.
void to_json(nlohmann::json& j, const Error& error) {
  const ErrorTraits& row = traits(error.code);
  j = {{"type", "urn:goniod:error:" + std::string(row.name)},
       {"title", row.title},
       {"status", row.http_status},
       {"detail", describe(error)},
       {"code", row.name},
       {"device", error.device},
       {"tried", error.tried},
       {"seen", error.seen},
       {"limit", error.limit},
       {"for_the_data", row.for_the_data},
       {"remedy", row.remedy}};
  if (error.where)
    j["where"] = {{"file", error.where->file}, {"line", error.where->line}, {"field", error.where->field}};
}

void from_json(const nlohmann::json& j, Error& error) {
  error.code = error_code_from_name(j.at("code").get<std::string>()).value_or(ErrorCode::Internal);
  error.device = j.value("device", "");
  error.tried = j.value("tried", "");
  error.seen = j.value("seen", "");
  error.limit = j.value("limit", "");
  if (!j.contains("where")) return;
  const nlohmann::json& where = j.at("where");
  error.where = InputLocation{where.value("file", ""), where.value("line", 0), where.value("field", "")};
}

namespace api {

using nlohmann::json;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AxisReport, name, unit, position, moving, homed, at_limit, fault)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(StageReport, age_s, moving, homed, halted, heartbeat_tripped,
                                                interlock_open, fault, epoch, boot_counter, source_shutter,
                                                detector_shutter, monitor, lamp_temperature_c, detector_temperature_c,
                                                room_temperature_c, humidity_percent, axes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(HoldReport, name, owner, reason, age_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(IdleSplit, commit_s, wire_s, device_s, hold_s, planning_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(TimeSplit, move_s, settle_s, expose_s, read_s, idle_s, idle_by)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ScanReport, id, name, campaign, sample, isotropic, state, outcome, who,
                                                reference, instrument_sha256, submitted_utc, changed_utc, points,
                                                merged, blocked, items, accepted, skipped, attempts, visits,
                                                reference_visits, check_visits, measured_again, largest_drift, spent,
                                                seconds_a_point, holds, doing, remaining_s, u_remaining_s,
                                                learned_from_scans, brdf_values, median_relative_u, worst_relative_u,
                                                priority, preempts, start_utc, queue_place, completes, completed_by,
                                                calibrations, plan, plan_file, plan_parts, checks)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(WarmUpReport, slope_percent_per_min, limit_percent_per_min, waited_s,
                                                at_least_s, at_most_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(StatusReport, version, instrument, instrument_sha256, uptime_s, doing,
                                                stage_stopped, active, queued, aside, warm_up, stage, stage_error,
                                                detector_error, store_error, last_event)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(HealthReport, ok, version)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PlanOrder, walk_s, bound_s, bound, as_written_s, snaked_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PlanMode, mode, estimate_s, median_relative_u, worst_relative_u,
                                                dominant, mixed_share, refused)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(BudgetReport, allowed_s, wished_s, directions, kept, repeats,
                                                kept_repeats, target_snr, widest_gap_deg)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PlanReport, name, sample, reference, planner_version, asked, points,
                                                merged, blocked, items, estimate, estimate_s, order, out_of_reach,
                                                without_partner, walk, u_estimate_s, visits, disk_bytes,
                                                median_relative_u, worst_relative_u, relative_u, learned_from_scans,
                                                budget, mode, modes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PointReport, index, rank, theta_i_deg, phi_i_deg, theta_r_deg,
                                                phi_r_deg, wavelength_nm, blocked, sample, reference, attempts)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(BrdfReport, point, theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg,
                                                wavelength_nm, brdf_per_sr, u_random_per_sr, u_shared_per_sr,
                                                u_own_per_sr, u_per_sr, k, expanded_u_per_sr, below_per_sr,
                                                above_per_sr, status, flags)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PointPage, points, next_after)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(BrdfPage, values, next_after)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ScanList, scans)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(CertificateEntryReport, wavelength_nm, reflectance, u)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ShapeModeReport, name, kind, u, width_deg)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ReferenceReport, serial, material, file, certificate_date, expires,
                                                error, geometry, from_nm, to_nm, last_theta_i_deg, last_theta_r_deg,
                                                table, largest_gap, findings, note, coverage_factor, correlation,
                                                u_integral, entries, modes, text)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ReferenceList, references)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(FoundValueReport, name, unit, value, u)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(CalibrationUseReport, utc, who, in_use, reason)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(CalibrationReport, version, job, scan, sample, counts, utc,
                                                code_version, note, values, covariance, inputs, uses)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(CalibrationList, calibrations)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ChartPointReport, scan, version, utc, value, u, deviation, broken)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ChartReport, standard, quantity, baseline, centre, sd, low, high,
                                                verdict, points)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(UseCalibrationRequest, in_use, reason)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(RecomputeRequest, calibration)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AxisLimits, name, unit, low, high, speed_per_s, acceleration_per_s2,
                                                settle_s, window)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(FilterReport, slot, centroid_nm, fwhm_nm, side, attenuation)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(InstrumentReport, name, sha256, stage_link, heartbeat_timeout_s, axes,
                                                filters, sample_mm, reference_mm, trap_mm, open_mm, detector_serial,
                                                shortest_exposure_s, longest_exposure_s, full_scale_dn, read_noise_dn,
                                                electrons_per_dn, monitor_low, monitor_high, store_free_bytes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(StopReport, epoch)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(CommandReport, scan, existed, note)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PlanSubmission, plan, plan_file, parts, priority, preempt, start_utc)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(MoveRequest, theta_i_deg, theta_r_deg, phi_r_deg, phi_i_deg,
                                                carriage_mm, filter_wheel_slot, source_shutter_open,
                                                detector_shutter_open)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(DetectorReadRequest, exposure_s, range_w, lit)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(DetectorReading, detector, unit, value, noise, values, saturated,
                                                full_scale, exposure_s, gain_db, wavelength_nm, temperature_c,
                                                source_shutter_open, detector_shutter_open)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PauseRequest, now, reason)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AbortRequest, reason)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ResumeRequest, hold)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ChangeRequest, target_snr, max_time_s, order, seed, priority, start_utc,
                                                reason)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ScanCheckReport, name, verdict, compared, unit, chi_square,
                                                degrees_of_freedom, worst_z, p_value, worst_points, finding)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ScanChecksReport, scan, summary, false_alarm, checks)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(BudgetTermReport, component, kind, distribution, u, unit, sensitivity,
                                                contribution_per_sr, share_percent, degrees_of_freedom)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PointBudgetReport, scan, point, chosen, theta_i_deg, phi_i_deg,
                                                theta_r_deg, phi_r_deg, wavelength_nm, brdf_per_sr, u_random_per_sr,
                                                u_shared_per_sr, u_per_sr, degrees_of_freedom, k, expanded_u_per_sr,
                                                below_per_sr, above_per_sr, method, flags, terms)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(ReferenceImport, text, file, shape, shape_file, shape_of, replace)

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AnalysisRequest, kind, scan, format, point, other_scan, other_model,
                                                other_file, other_bytes, others, model, deadline_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AnalysisLoss, kind, values, what)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AnalysisFile, name, bytes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AnalysisFact, name, value, expanded_u, unit, note)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AnalysisReport, id, kind, scan, state, who, progress, doing,
                                                submitted_utc, ended_utc, error, files, losses, facts, notes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(AnalysisList, jobs)

void to_json(json& j, const NoWords&) {
  j = json::object();
}
void from_json(const json&, NoWords&) {}

// The data of an event are JSON already.
void to_json(json& j, const Event& event) {
  json data = json::parse(event.data, nullptr, false);
  if (data.is_discarded()) data = json::object();
  j = {{"number", event.number}, {"kind", event.kind}, {"kind_version", event.kind_version},
       {"scan", event.scan},     {"who", event.who},   {"utc", event.utc},
       {"data", std::move(data)}};
}

void from_json(const json& j, Event& event) {
  event.number = j.value("number", std::int64_t{0});
  event.kind = j.value("kind", "");
  event.kind_version = j.value("kind_version", 1);
  event.scan = j.value("scan", std::int64_t{0});
  event.who = j.value("who", "");
  event.utc = j.value("utc", "");
  event.data = j.value("data", json::object()).dump();
}

namespace {

std::string dumped(const json& j) {
  return j.dump(-1, ' ', false, json::error_handler_t::replace);
}

Error bad_member(std::string field, std::string seen, std::string limit = {}) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "read the request's body",
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{"", 0, std::move(field)}};
}

std::string member_names(const json& object) {
  std::string names;
  for (const auto& [name, value] : object.items()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

}  // namespace

template <class T>
std::string to_json(const T& message) {
  return dumped(json(message));
}

template <class T>
Result<T> report_from_json(std::string_view text) {
  try {
    return json::parse(text).get<T>();
  } catch (const json::exception& e) {
    return failure(
        {.code = ErrorCode::BadReply, .device = "daemon", .tried = "read its answer", .seen = e.what(), .limit = {}});
  }
}

template <class T>
Result<T> request_from_json(std::string_view text) {
  const json body = text.empty() ? json::object() : json::parse(text, nullptr, false);
  if (!body.is_object()) return failure(bad_member("", "it is not a JSON object", "one object"));
  const json known = T{};
  for (const auto& [name, value] : body.items()) {
    if (!known.contains(name)) {
      Error error = bad_member(name, "there is no member \"" + name + "\"", "known: " + member_names(known));
      error.code = ErrorCode::UnknownKey;
      return failure(std::move(error));
    }
    try {
      (void)json{{name, value}}.get<T>();
    } catch (const json::exception&) {
      return failure(bad_member(name, "its type is " + std::string(value.type_name())));
    }
  }
  return body.get<T>();
}

std::string to_problem_json(const Error& error, int http_status) {
  json problem = error;
  if (http_status != 0) problem["status"] = http_status;
  return dumped(problem);
}

Error error_from_problem(int http_status, std::string_view body) {
  const json problem = json::parse(body, nullptr, false);
  try {
    if (problem.is_object() && problem.contains("code")) return problem.get<Error>();
  } catch (const json::exception&) {
    // falls through to what any strange answer gets
  }
  constexpr std::size_t kFirstWords = 80;
  return {.code = ErrorCode::BadReply,
          .device = "daemon",
          .tried = "read its answer",
          .seen = "HTTP status " + std::to_string(http_status) + ": " + std::string(body.substr(0, kFirstWords)),
          .limit = {}};
}

#define GONIO_REPORT(T)                   \
  template std::string to_json(const T&); \
  template Result<T> report_from_json<T>(std::string_view)
#define GONIO_REQUEST(T)                  \
  template std::string to_json(const T&); \
  template Result<T> request_from_json<T>(std::string_view)

GONIO_REPORT(StageReport);
GONIO_REPORT(ScanReport);
GONIO_REPORT(StatusReport);
GONIO_REPORT(HealthReport);
GONIO_REPORT(PlanReport);
GONIO_REPORT(PointPage);
GONIO_REPORT(BrdfPage);
GONIO_REPORT(ScanList);
GONIO_REPORT(ReferenceReport);
GONIO_REPORT(ReferenceList);
GONIO_REPORT(CalibrationReport);
GONIO_REPORT(CalibrationList);
GONIO_REPORT(ChartReport);
GONIO_REPORT(InstrumentReport);
GONIO_REPORT(Event);
GONIO_REPORT(StopReport);
GONIO_REPORT(CommandReport);
GONIO_REPORT(DetectorReading);
GONIO_REPORT(AnalysisReport);
GONIO_REPORT(AnalysisList);
GONIO_REQUEST(AnalysisRequest);
GONIO_REQUEST(PlanSubmission);
GONIO_REQUEST(MoveRequest);
GONIO_REQUEST(DetectorReadRequest);
GONIO_REQUEST(PauseRequest);
GONIO_REQUEST(AbortRequest);
GONIO_REQUEST(ResumeRequest);
GONIO_REQUEST(ChangeRequest);
GONIO_REQUEST(UseCalibrationRequest);
GONIO_REQUEST(RecomputeRequest);
GONIO_REPORT(ScanCheckReport);
GONIO_REPORT(ScanChecksReport);
GONIO_REPORT(BudgetTermReport);
GONIO_REPORT(PointBudgetReport);
GONIO_REQUEST(ReferenceImport);
GONIO_REQUEST(NoWords);

}  // namespace api
}  // namespace gonio
