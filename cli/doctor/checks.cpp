#include "cli/doctor/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "cli/output.h"

namespace gonio::cli {
namespace {

constexpr double kOldestLook_s = 3.0;  // the daemon looks at the stage once a second
constexpr std::int64_t kGibibyte = 1LL << 30;

Finding ok(std::string check, std::string seen, std::string limit = {}) {
  return {.check = std::move(check), .seen = std::move(seen), .limit = std::move(limit)};
}

Finding found(std::string check, Verdict verdict, std::string seen, std::string limit, std::string remedy) {
  return {.check = std::move(check),
          .verdict = verdict,
          .seen = std::move(seen),
          .limit = std::move(limit),
          .remedy = std::move(remedy)};
}

Finding device_error(std::string check, const std::optional<Error>& error) {
  if (!error) return ok(std::move(check), "no error");
  return found(std::move(check), Verdict::Failed, describe(*error), "", std::string(traits(error->code).remedy));
}

Finding check_latches(const api::StageReport& stage) {
  const std::string check = "stage is free to move";
  if (stage.interlock_open) {
    return found(check, Verdict::Failed, "the interlock is open", "closed", "close the door or its switch's circuit");
  }
  if (stage.fault != 0) {
    return found(check, Verdict::Failed, fmt::format("fault {}", stage.fault), "no fault",
                 "find the cause at the drive, then: gonioctl stage reset");
  }
  if (stage.halted) return found(check, Verdict::Failed, "STOP stands", "no STOP", "gonioctl stage reset");
  if (stage.heartbeat_tripped) {
    return found(check, Verdict::Warning, "the heartbeat was missed", "", "the next command clears it");
  }
  return ok(check, "no interlock, fault, STOP or missed heartbeat");
}

Finding check_home(const api::StageReport& stage) {
  if (stage.homed) return ok("stage is homed", "all axes");
  return found("stage is homed", Verdict::Warning, "an axis does not know where it is", "all axes homed",
               "gonioctl stage home; a scan does it by itself");
}

Finding check_monitor(const api::StageReport& stage, const api::InstrumentReport& instrument) {
  const std::string seen = number_text(stage.monitor);
  const std::string limit =
      fmt::format("{} to {}", number_text(instrument.monitor_low), number_text(instrument.monitor_high));
  if (stage.monitor >= instrument.monitor_low && stage.monitor <= instrument.monitor_high) {
    return ok("lamp monitor is in its band", seen, limit);
  }
  return found(
      "lamp monitor is in its band", Verdict::Failed, seen, limit,
      "is the lamp on and warm, and the monitor's head in its light? Then see [lamp] monitor_low, monitor_high");
}

// A wire that is not connected reads as the end of a scale, or as exactly nothing.
Finding check_temperature(const std::string& check, double value_c) {
  const bool can_be = value_c > -40.0 && value_c < 150.0 && value_c != 0.0;
  const std::string seen = number_text(value_c, 4) + " deg C";
  if (can_be) return ok(check, seen);
  return found(check, Verdict::Warning, seen, "-40 to 150 deg C, not exactly 0", "is the sensor connected?");
}

Finding check_humidity(double percent) {
  const std::string seen = number_text(percent, 4) + " %";
  if (percent > 0.0 && percent <= 100.0) return ok("humidity sensor", seen);
  return found("humidity sensor", Verdict::Warning, seen, "above 0, up to 100 %", "is the sensor connected?");
}

// Whole days since a fixed day, for differences (civil days: Howard Hinnant 2013, days_from_civil).
long days_of(const std::string& date) {
  int year = 0, month = 0, day = 0;
  if (std::sscanf(date.c_str(), "%d-%d-%d", &year, &month, &day) != 3) return 0;
  year -= month <= 2 ? 1 : 0;
  const long era = (year >= 0 ? year : year - 399) / 400;
  const long of_era = year - era * 400;
  const long of_year = (153L * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year;
}

Finding check_reference(const api::ReferenceReport& reference, const std::string& today) {
  const std::string check = "reference " + (reference.serial.empty() ? reference.file : reference.serial);
  constexpr long kSoon_days = 60;
  if (reference.error) return device_error(check, reference.error);
  const long left = days_of(reference.expires) - days_of(today);
  const std::string seen = fmt::format("certificate of {}, until {}", reference.certificate_date, reference.expires);
  if (left < 0) {
    return found(check, Verdict::Failed, seen, "not expired", "have it calibrated; plans that name it are refused");
  }
  if (left < kSoon_days) {
    return found(check, Verdict::Warning, fmt::format("{}: {} days left", seen, left), "", "plan its calibration now");
  }
  return ok(check, seen);
}

}  // namespace

std::string_view verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::Ok:
      return "ok";
    case Verdict::Warning:
      return "warning";
    case Verdict::Failed:
      return "FAILED";
    case Verdict::Skipped:
      break;
  }
  return "skipped";
}

std::vector<Finding> check_daemon(const api::StatusReport& status, const std::string& own_version) {
  std::vector<Finding> findings;
  if (status.version == own_version) {
    findings.push_back(
        ok("daemon answers", fmt::format("goniod {}, up {}", status.version, duration_text(status.uptime_s))));
  } else {
    findings.push_back(found("daemon answers", Verdict::Warning, "goniod " + status.version, "gonioctl " + own_version,
                             "install both of one version"));
  }
  findings.push_back(device_error("store", status.store_error));
  findings.push_back(device_error("stage answers", status.stage_error));
  if (!status.stage_error && !status.stage) {
    findings.back() = found("stage answers", Verdict::Failed, "nothing yet", "an answer",
                            "is it switched on, and [stage] address its own?");
  } else if (!status.stage_error && status.stage->age_s > kOldestLook_s) {
    findings.back() = found("stage answers", Verdict::Failed, fmt::format("last {:.1f} s ago", status.stage->age_s),
                            fmt::format("every {} s", kOldestLook_s), "see goniod's log");
  }
  findings.push_back(device_error("detector", status.detector_error));
  return findings;
}

std::vector<Finding> check_stage(const api::StageReport& stage, const api::InstrumentReport& instrument) {
  return {check_latches(stage),
          check_home(stage),
          check_monitor(stage, instrument),
          check_temperature("lamp temperature sensor", stage.lamp_temperature_c),
          check_temperature("detector temperature sensor", stage.detector_temperature_c),
          check_temperature("room temperature sensor", stage.room_temperature_c),
          check_humidity(stage.humidity_percent)};
}

std::vector<Finding> check_instrument(const api::InstrumentReport& instrument) {
  const std::string free =
      fmt::format("{:.1f} GiB free", static_cast<double>(instrument.store_free_bytes) / static_cast<double>(kGibibyte));
  if (instrument.store_free_bytes >= 10 * kGibibyte) return {ok("disk of the store", free)};
  const Verdict verdict = instrument.store_free_bytes < kGibibyte ? Verdict::Failed : Verdict::Warning;
  return {found("disk of the store", verdict, free, "10 GiB", "make room: a full disk holds every scan")};
}

std::vector<Finding> check_references(const api::ReferenceList& references, const std::string& today) {
  if (references.references.empty()) {
    return {found("reference standards", Verdict::Failed, "none", "at least one",
                  "put the certificate into reference/SERIAL.toml beside the instrument's file")};
  }
  std::vector<Finding> findings;
  for (const api::ReferenceReport& reference : references.references) {
    findings.push_back(check_reference(reference, today));
  }
  return findings;
}

double told_time_s(const api::AxisLimits& axis, double way) {
  const double d = std::abs(way);
  const double ramp = axis.speed_per_s * axis.speed_per_s / axis.acceleration_per_s2;  // both ramps together
  const double travel = d < ramp ? 2.0 * std::sqrt(d / axis.acceleration_per_s2)
                                 : d / axis.speed_per_s + axis.speed_per_s / axis.acceleration_per_s2;
  return travel + axis.settle_s;
}

double trial_target(const api::AxisLimits& axis, double standing) {
  constexpr double kShare = 0.1;
  constexpr double kMost = 10.0;
  double way = std::min(kMost, kShare * (axis.high - axis.low));
  if (axis.unit == "slot") way = 1.0;
  const bool upwards = axis.high - standing >= standing - axis.low;
  return std::clamp(standing + (upwards ? way : -way), axis.low, axis.high);
}

Finding check_axis_move(const api::AxisLimits& axis, double from, double to, double arrived, double took_s) {
  const std::string check = fmt::format("axis {} moves", axis.name);
  const double told = told_time_s(axis, to - from);
  const std::string seen =
      fmt::format("{:.3f} to {:.3f} {}: stands at {:.4f} after {:.2f} s", from, to, axis.unit, arrived, took_s);
  const std::string limit = fmt::format("+- {} {} in {:.2f} s", number_text(axis.window, 3), axis.unit, told);
  if (std::abs(arrived - to) > axis.window) {
    return found(check, Verdict::Failed, seen, limit, "sign, scale and offset of its register; then the drive itself");
  }
  constexpr double kSlack_s = 0.5;  // of looks and of the way to the daemon
  if (took_s > 1.25 * told + kSlack_s) {
    return found(check, Verdict::Warning, seen, limit, "it is slower than its speed, acceleration and settle time say");
  }
  if (took_s < 0.5 * told - kSlack_s) {
    return found(check, Verdict::Warning, seen, limit, "it is faster than its speed and acceleration say: ETA is off");
  }
  return ok(check, seen, limit);
}

}  // namespace gonio::cli
