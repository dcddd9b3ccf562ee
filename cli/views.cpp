#include "cli/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace gonio::cli {
namespace {

constexpr double kPercent = 100.0;

std::string yes_no(bool value) {
  return value ? "yes" : "no";
}

// A row in the making, each cell with its name.
class Facts {
 public:
  Facts& add(std::string name, std::string value) {
    table_.header.push_back(std::move(name));
    table_.rows[0].push_back(std::move(value));
    return *this;
  }
  [[nodiscard]] Table take() { return std::move(table_); }

 private:
  Table table_{.header = {}, .rows = {{}}};
};

std::string split_text(const api::TimeSplit& split) {
  return fmt::format("{:.3f} s (move {:.3f}, settle {:.3f}, expose {:.3f}, read {:.3f}, idle {:.3f})", split.total_s(),
                     split.move_s, split.settle_s, split.expose_s, split.read_s, split.idle_s);
}

std::string idle_text(const api::IdleSplit& idle) {
  return fmt::format("commit {:.4f}, wire {:.4f}, device {:.4f}, hold {:.4f}, planning {:.4f}", idle.commit_s,
                     idle.wire_s, idle.device_s, idle.hold_s, idle.planning_s);
}

std::string error_text(const std::optional<Error>& error) {
  return error ? describe(*error) : std::string();
}

std::string percent_text(const std::optional<double>& fraction) {
  return fraction ? fmt::format("{:.3g} %", kPercent * *fraction) : std::string();
}

double share(const api::ScanReport& scan) {
  if (scan.items == 0) return 0.0;
  return kPercent * static_cast<double>(scan.accepted + scan.skipped) / static_cast<double>(scan.items);
}

// Under way first, then the queue in its order, then what is over.
std::int64_t place_in_list(const api::ScanReport& scan) {
  if (scan.queue_place) return *scan.queue_place;
  const bool is_over =
      scan.state == "done" || scan.state == "finished-early" || scan.state == "aborted" || scan.state == "failed";
  return is_over ? std::numeric_limits<std::int64_t>::max() : 0;
}

std::string warm_up_text(const std::optional<api::WarmUpReport>& warm_up) {
  if (!warm_up) return {};
  const std::string slope = warm_up->slope_percent_per_min
                                ? fmt::format("{:.3g} %/min", *warm_up->slope_percent_per_min)
                                : std::string("not known yet");
  return fmt::format("its slope is {}, limit {:.3g} %/min; waited {}, at least {} more, at most {}", slope,
                     warm_up->limit_percent_per_min, duration_text(warm_up->waited_s),
                     duration_text(warm_up->at_least_s), duration_text(warm_up->at_most_s));
}

std::string numbers_text(const std::vector<std::int64_t>& numbers) {
  std::string text;
  for (const std::int64_t number : numbers) text += (text.empty() ? "" : ", ") + std::to_string(number);
  return text;
}

std::string scan_number(std::int64_t scan) {
  return scan == 0 ? std::string() : std::to_string(scan);
}

std::string stage_words(const api::StageReport& stage) {
  std::string words = stage.homed ? "homed" : "not homed";
  if (stage.moving) words += ", moving";
  if (stage.halted) words += ", STOPPED (clear with: gonioctl stage reset)";
  if (stage.heartbeat_tripped) words += ", heartbeat missed";
  if (stage.interlock_open) words += ", interlock open";
  if (stage.fault != 0) words += fmt::format(", fault {}", stage.fault);
  return words;
}

std::string order_text(const api::PlanOrder& order) {
  if (order.bound_s <= 0.0) return duration_text(order.walk_s);
  return fmt::format("{} a pass, {:.3f} of the bound ({})", duration_text(order.walk_s), order.walk_s / order.bound_s,
                     order.bound);
}

}  // namespace

std::string visits_text(const api::ScanReport& scan) {
  const std::int64_t darks = scan.visits - scan.reference_visits - scan.check_visits;
  return fmt::format("{} dark, {} reference, {} check", darks, scan.reference_visits, scan.check_visits);
}

std::string drift_text(const api::ScanReport& scan) {
  return scan.reference_visits + scan.check_visits > 1 ? percent_text(scan.largest_drift) : "";
}

std::string holds_text(const api::ScanReport& scan) {
  std::string text;
  for (const api::HoldReport& hold : scan.holds) {
    text += fmt::format("{}{} ({}: {})", text.empty() ? "" : ", ", hold.name, hold.owner, hold.reason);
  }
  return text;
}

std::string progress_text(const api::ScanReport& scan) {
  std::string text = fmt::format("scan {} {}: {} of {} items, {:.1f} %, {}", scan.id, scan.name,
                                 scan.accepted + scan.skipped, scan.items, share(scan), scan.state);
  if (scan.remaining_s) {
    text += fmt::format(", {} to go", duration_text(*scan.remaining_s));
    if (scan.u_remaining_s) text += fmt::format(" (+- {})", duration_text(*scan.u_remaining_s));
    if (scan.learned_from_scans > 0) text += fmt::format(", predicted from {} scans", scan.learned_from_scans);
  }
  const std::string holds = holds_text(scan);
  if (!holds.empty()) text += ": " + holds;
  return text;
}

Table view(const api::StatusReport& status) {
  Facts facts;
  facts.add("daemon", "goniod " + status.version)
      .add("instrument", status.instrument)
      .add("instrument_sha256", status.instrument_sha256)
      .add("uptime", duration_text(status.uptime_s))
      .add("doing", status.doing)
      .add("scan", status.active ? progress_text(*status.active) : "none")
      .add("preempted", numbers_text(status.aside))
      .add("queued", numbers_text(status.queued))
      .add("lamp", warm_up_text(status.warm_up))
      .add("stage", status.stage ? stage_words(*status.stage) : "not seen yet")
      .add("stage_error", error_text(status.stage_error))
      .add("detector_error", error_text(status.detector_error))
      .add("store_error", error_text(status.store_error))
      .add("last_event", std::to_string(status.last_event));
  return facts.take();
}

Table view(const api::StageReport& stage) {
  Facts facts;
  facts.add("stage", stage_words(stage)).add("age_s", number_text(stage.age_s, 3));
  for (const api::AxisReport& axis : stage.axes)
    facts.add(axis.name + "_" + axis.unit, fmt::format("{:.4f}", axis.position));
  facts.add("source_shutter", stage.source_shutter)
      .add("detector_shutter", stage.detector_shutter)
      .add("monitor", number_text(stage.monitor))
      .add("lamp_temperature_c", number_text(stage.lamp_temperature_c, 4))
      .add("detector_temperature_c", number_text(stage.detector_temperature_c, 4))
      .add("room_temperature_c", number_text(stage.room_temperature_c, 4))
      .add("humidity_percent", number_text(stage.humidity_percent, 4))
      .add("epoch", std::to_string(stage.epoch));
  return facts.take();
}

std::string budget_text(const api::BudgetReport& budget) {
  std::string text = fmt::format("{} of {}: {} of {} directions", duration_text(budget.allowed_s),
                                 duration_text(budget.wished_s), budget.kept, budget.directions);
  if (budget.kept < budget.directions) text += fmt::format(", gaps up to {:.1f} deg", budget.widest_gap_deg);
  if (budget.repeats > 0) text += fmt::format(", {} of {} repeats", budget.kept_repeats, budget.repeats);
  return text + fmt::format(", signal to noise {:.0f}", budget.target_snr);
}

std::string mode_text(const api::PlanMode& mode, const std::string& own) {
  const std::string mark = mode.mode == own ? "this plan's: " : "";
  if (mode.refused) return mark + "not to be had: " + *mode.refused;
  const std::string mixed =
      mode.mixed_share > 0.0 ? fmt::format("; {:.0f} % of the points mixed", 100.0 * mode.mixed_share) : "";
  return fmt::format("{}{}; U median {:.2f} %, worst {:.2f} %, there mostly {}{}", mark, duration_text(mode.estimate_s),
                     100.0 * mode.median_relative_u, 100.0 * mode.worst_relative_u, mode.dominant, mixed);
}

Table view(const api::PlanReport& plan) {
  Facts facts;
  facts.add("plan", plan.name)
      .add("sample", plan.sample)
      .add("reference", plan.reference)
      .add("asked", std::to_string(plan.asked))
      .add("points", std::to_string(plan.points))
      .add("merged", std::to_string(plan.merged))
      .add("blocked", std::to_string(plan.blocked))
      .add("items", std::to_string(plan.items))
      .add("out_of_reach", std::to_string(plan.out_of_reach))
      .add("without_partner", std::to_string(plan.without_partner.size()))
      .add("estimate", fmt::format("{} +- {}", duration_text(plan.estimate_s), duration_text(plan.u_estimate_s)))
      .add("rests_on", fmt::format("{} finished scans", plan.learned_from_scans))
      .add("budget", plan.budget ? budget_text(*plan.budget) : "")
      .add("of_which", split_text(plan.estimate))
      .add("as_written", duration_text(plan.walk.as_written_s))
      .add("to_and_fro", duration_text(plan.walk.snaked_s))
      .add("walk", order_text(plan.walk))
      .add("visits", std::to_string(plan.visits))
      .add("disk", fmt::format("{:.1f} MB", 1e-6 * static_cast<double>(plan.disk_bytes)))
      .add("expected_U", fmt::format("median {:.2f} %, worst {:.2f} %, of what is known before the sample is",
                                     100.0 * plan.median_relative_u, 100.0 * plan.worst_relative_u));
  for (const api::PlanMode& mode : plan.modes) facts.add("mode " + mode.mode, mode_text(mode, plan.mode));
  return facts.take();
}

Table view(const api::ScanReport& scan) {
  Facts facts;
  facts.add("scan", std::to_string(scan.id))
      .add("name", scan.name)
      .add("sample", scan.sample)
      .add("reference", scan.reference)
      .add("state", scan.state)
      .add("outcome", scan.outcome)
      .add("holds", holds_text(scan))
      .add("doing", scan.doing)
      .add("who", scan.who)
      .add("priority", std::to_string(scan.priority))
      .add("turn", scan.queue_place ? std::to_string(*scan.queue_place) : "")
      .add("start_utc", scan.start_utc.value_or(""))
      .add("completes", scan_number(scan.completes))
      .add("completed_by", scan_number(scan.completed_by))
      .add("submitted_utc", scan.submitted_utc)
      .add("changed_utc", scan.changed_utc)
      .add("points", std::to_string(scan.points))
      .add("merged", std::to_string(scan.merged))
      .add("blocked", std::to_string(scan.blocked))
      .add("items", std::to_string(scan.items))
      .add("accepted", std::to_string(scan.accepted))
      .add("skipped", std::to_string(scan.skipped))
      .add("attempts", std::to_string(scan.attempts))
      .add("visits", visits_text(scan))
      .add("largest_drift", drift_text(scan))
      .add("measured_again", scan.measured_again > 0 ? std::to_string(scan.measured_again) + " points" : "")
      .add("a_point", split_text(scan.seconds_a_point))
      .add("idle_of_it_s", idle_text(scan.seconds_a_point.idle_by))
      .add("to_go", scan.remaining_s ? duration_text(*scan.remaining_s) : "")
      .add("brdf_values", scan.brdf_values ? std::to_string(*scan.brdf_values) : "")
      .add("calibrations", scan.calibrations ? (scan.calibrations->empty() ? "none" : *scan.calibrations) : "")
      .add("median_U", percent_text(scan.median_relative_u))
      .add("worst_U", percent_text(scan.worst_relative_u))
      .add("checks", scan.checks.value_or(""))
      .add("instrument_sha256", scan.instrument_sha256);
  return facts.take();
}

Table view(const api::ScanList& scans) {
  Table table{.header = {"scan", "state", "done_percent", "accepted", "items", "sample", "submitted_utc", "name",
                         "priority", "turn", "start_utc"},
              .rows = {}};
  std::vector<api::ScanReport> in_order = scans.scans;
  std::stable_sort(in_order.begin(), in_order.end(),
                   [](const auto& a, const auto& b) { return place_in_list(a) < place_in_list(b); });
  for (const api::ScanReport& scan : in_order) {
    table.rows.push_back({std::to_string(scan.id), scan.state, fmt::format("{:.1f}", share(scan)),
                          std::to_string(scan.accepted), std::to_string(scan.items), scan.sample, scan.submitted_utc,
                          scan.name, std::to_string(scan.priority),
                          scan.queue_place ? std::to_string(*scan.queue_place) : "", scan.start_utc.value_or("")});
  }
  return table;
}

Table view(const api::InstrumentReport& instrument) {
  Facts facts;
  facts.add("instrument", instrument.name)
      .add("sha256", instrument.sha256)
      .add("stage", instrument.stage_link)
      .add("heartbeat_timeout_s", number_text(instrument.heartbeat_timeout_s));
  for (const api::AxisLimits& axis : instrument.axes) {
    facts.add(axis.name,
              fmt::format("{} to {} {}, {} {}/s, {} {}/s^2, settles in {} s within +- {} {}", axis.low, axis.high,
                          axis.unit, number_text(axis.speed_per_s), axis.unit, number_text(axis.acceleration_per_s2),
                          axis.unit, axis.settle_s, number_text(axis.window), axis.unit));
  }
  for (const api::FilterReport& filter : instrument.filters) {
    facts.add(
        fmt::format("filter_{}", filter.slot),
        fmt::format("{} nm, {} nm wide, {} side{}", number_text(filter.centroid_nm), number_text(filter.fwhm_nm),
                    filter.side, filter.attenuation ? fmt::format(", attenuated to {:g}", *filter.attenuation) : ""));
  }
  facts
      .add("carriage_mm",
           fmt::format("sample {}, reference {}, trap {}{}", instrument.sample_mm, instrument.reference_mm,
                       instrument.trap_mm, instrument.open_mm ? fmt::format(", open {}", *instrument.open_mm) : ""))
      .add("detector", instrument.detector_serial)
      .add("exposures_s",
           fmt::format("{} to {}, by twos", instrument.shortest_exposure_s, instrument.longest_exposure_s))
      .add("lamp_monitor", fmt::format("{} to {}", instrument.monitor_low, instrument.monitor_high))
      .add("store_free_bytes", std::to_string(instrument.store_free_bytes));
  return facts.take();
}

Table view(const api::DetectorReading& reading) {
  Facts facts;
  facts.add("detector", reading.detector)
      .add("unit", reading.unit)
      .add("value", reading.value ? number_text(*reading.value) : "overload")
      .add("noise", number_text(reading.noise, 4))
      .add("values", std::to_string(reading.values))
      .add("saturated", std::to_string(reading.saturated))
      .add("full_scale", number_text(reading.full_scale))
      .add("exposure_s", number_text(reading.exposure_s));
  if (reading.wavelength_nm) facts.add("wavelength_nm", number_text(*reading.wavelength_nm));
  if (reading.temperature_c) facts.add("temperature_c", number_text(*reading.temperature_c, 4));
  facts.add("source_shutter_open", yes_no(reading.source_shutter_open))
      .add("detector_shutter_open", yes_no(reading.detector_shutter_open));
  return facts.take();
}

Table view(const api::CommandReport& command) {
  Facts facts;
  if (command.scan != 0) facts.add("scan", std::to_string(command.scan));
  facts.add("done", yes_no(true));
  if (command.existed) facts.add("existed", yes_no(true));
  if (!command.note.empty()) facts.add("note", command.note);
  return facts.take();
}

Table view(const api::StopReport& stop) {
  Facts facts;
  facts.add("stopped", "nothing moves until: gonioctl stage reset").add("epoch", std::to_string(stop.epoch));
  return facts.take();
}

Table view(const api::Event& event) {
  return {.header = {"number", "utc", "kind", "scan", "who", "data"},
          .rows = {{std::to_string(event.number), event.utc, event.kind, std::to_string(event.scan), event.who,
                    event.data}}};
}

}  // namespace gonio::cli
