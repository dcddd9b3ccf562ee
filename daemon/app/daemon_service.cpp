#include "daemon/app/daemon_service.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/utc_text.h"
#include "daemon/app/log.h"
#include "daemon/desks/completion_desk.h"
#include "daemon/desks/hand_reading_report.h"
#include "daemon/desks/instrument_report.h"
#include "daemon/desks/mode_outlook.h"
#include "daemon/desks/plan_desk.h"
#include "daemon/desks/plan_outlook.h"
#include "daemon/desks/reference_desk.h"
#include "daemon/desks/rest_order.h"
#include "daemon/desks/scan_reports.h"
#include "daemon/desks/scan_review.h"
#include "daemon/planner/order_report.h"
#include "daemon/results/calibration_desk.h"
#include "daemon/results/job_desk.h"
#include "daemon/results/map_run.h"
#include "daemon/results/results.h"
#include "daemon/results/version_desk.h"
#include "daemon/store/policy_names.h"
#include "daemon/store/version_list.h"

namespace gonio::daemon {
namespace {

constexpr int kScansShown = 1000;
constexpr std::size_t kOrderShown = 1000;

drivers::MotionTarget target_of(const api::MoveRequest& request) {
  drivers::MotionTarget target{};
  const auto set = [&](stage::Axis axis, const std::optional<double>& value) { target[stage::index_of(axis)] = value; };
  set(stage::Axis::ThetaI, request.theta_i_deg);
  set(stage::Axis::ThetaR, request.theta_r_deg);
  set(stage::Axis::PhiR, request.phi_r_deg);
  set(stage::Axis::PhiI, request.phi_i_deg);
  set(stage::Axis::Carriage, request.carriage_mm);
  set(stage::Axis::FilterWheel, request.filter_wheel_slot);
  return target;
}

Verb verb_of(ScanId scan, ScanVerb verb, const std::string& reason) {
  switch (verb) {
    case ScanVerb::Pause:
      return PauseScan{.scan = scan, .now = false, .reason = reason};
    case ScanVerb::PauseNow:
      return PauseScan{.scan = scan, .now = true, .reason = reason};
    case ScanVerb::Finish:
      return FinishScan{scan};
    case ScanVerb::Abort:
      return AbortScan{.scan = scan, .reason = reason};
    case ScanVerb::Skip:
      break;
  }
  return SkipItemInHand{scan};
}

ScanAsk ask_of(ScanVerb verb) {
  switch (verb) {
    case ScanVerb::Pause:
      return ScanAsk::Pause;
    case ScanVerb::PauseNow:
      return ScanAsk::PauseNow;
    case ScanVerb::Finish:
      return ScanAsk::Finish;
    case ScanVerb::Abort:
      return ScanAsk::Abort;
    case ScanVerb::Skip:
      break;
  }
  return ScanAsk::Skip;
}

Error no_such(const std::string& field, const std::string& seen, const std::string& limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "read the request",
          .seen = "\"" + seen + "\"",
          .limit = limit,
          .where = InputLocation{"", 0, field}};
}

Result<void> check_priority(int priority) {
  if (priority >= -kHighestPriority && priority <= kHighestPriority) return {};
  return failure({.code = ErrorCode::OutOfLimits,
                  .tried = "queue the scan",
                  .seen = fmt::format("priority {}", priority),
                  .limit = fmt::format("-{0} to {0}", kHighestPriority),
                  .where = InputLocation{"", 0, "priority"}});
}

Result<ChangeScan> change_of(std::int64_t scan, const api::ChangeRequest& request) {
  ChangeScan change{.scan = scan,
                    .target_snr = request.target_snr,
                    .seed = static_cast<std::uint64_t>(request.seed),
                    .priority = request.priority,
                    .reason = request.reason};
  if (request.max_time_s) change.max_time = seconds(*request.max_time_s);
  if (!request.order) return change;
  change.order = rest_order_from_name(*request.order);
  if (change.order) return change;
  return failure(no_such("order", *request.order, "as-written, reversed, random, fastest"));
}

NewScan new_scan(CheckedPlan checked, const api::PlanSubmission& submission, const std::string& key,
                 const std::string& who, const Instrument& instrument) {
  NewScan scan;
  scan.idempotency_key = key;
  scan.name = checked.plan.name;
  scan.sample = checked.plan.sample;
  scan.isotropic = checked.plan.isotropic;
  scan.policy = policy_of(checked.plan, checked.planned);
  scan.plan_text = submission.plan;
  scan.plan_file = submission.plan_file;
  scan.plan_parts = submission.parts;
  scan.reference_serial = checked.plan.reference_standard;
  scan.reference_text = std::move(checked.reference.text);
  scan.instrument_text = instrument.text;
  scan.instrument_hash = instrument.sha256;
  scan.planned = std::move(checked.planned);
  scan.who = who;
  return scan;
}

void add_modes(api::PlanReport& report, const CheckedPlan& checked, const Instrument& instrument) {
  const auto name = [](api::ReferenceMode mode) {
    return std::string(kReferenceModeNames[static_cast<std::size_t>(mode)]);
  };
  report.mode = name(checked.plan.reference_mode);
  for (const ModeOutlook& one : mode_outlooks(checked.plan, checked.planned, instrument, *checked.reference.standard)) {
    api::PlanMode mode{.mode = name(one.mode),
                       .estimate_s = in_seconds(one.time),
                       .median_relative_u = one.median_relative_u,
                       .worst_relative_u = one.worst_relative_u,
                       .dominant = one.dominant,
                       .mixed_share = one.looked_at == 0 ? 0.0 : static_cast<double>(one.mixed) / one.looked_at,
                       .refused = std::nullopt};
    if (!one.refused.empty()) mode.refused = one.refused;
    report.modes.push_back(std::move(mode));
  }
}

void add_outlook(api::PlanReport& report, const CheckedPlan& checked, const Instrument& instrument) {
  const OrderReport order = judge_order(checked.plan, instrument, checked.planned);
  report.walk = {.walk_s = in_seconds(order.walk),
                 .bound_s = in_seconds(order.bound),
                 .bound = order.is_held_karp ? "Held-Karp" : "two nearest",
                 .as_written_s = in_seconds(order.as_written),
                 .snaked_s = in_seconds(order.snaked)};
  if (!checked.reference.standard) return;
  const PlanOutlook ahead = outlook(checked.plan, checked.planned, instrument, *checked.reference.standard);
  report.visits = ahead.visits;
  report.disk_bytes = ahead.disk_bytes;
  report.median_relative_u = ahead.median_relative_u;
  report.worst_relative_u = ahead.worst_relative_u;
  report.relative_u = ahead.relative_u;
  report.relative_u.resize(std::min(kOrderShown, report.relative_u.size()));
  add_modes(report, checked, instrument);
}

api::BudgetReport budget_report(const BudgetChoice& choice) {
  return {.allowed_s = in_seconds(choice.allowed),
          .wished_s = in_seconds(choice.wished),
          .directions = choice.directions,
          .kept = choice.kept,
          .repeats = choice.repeats,
          .kept_repeats = choice.kept_repeats,
          .target_snr = choice.target_snr,
          .widest_gap_deg = in_degrees(choice.widest_gap)};
}

api::PlanReport plan_report(const CheckedPlan& checked, const Instrument& instrument) {
  api::PlanReport report;
  report.name = checked.plan.name;
  report.sample = checked.plan.sample;
  report.reference = checked.plan.reference_standard;
  report.planner_version = checked.planned.planner_version;
  report.asked = checked.planned.asked;
  report.points = std::ssize(checked.planned.points);
  report.merged = checked.planned.merged;
  report.blocked = checked.planned.blocked;
  report.items = checked.planned.items;
  report.estimate = time_split(checked.planned.estimate);
  report.estimate_s = report.estimate.total_s();
  report.u_estimate_s = checked.planned.u_estimate_s;
  report.learned_from_scans = checked.planned.experience.scans;
  if (checked.planned.budget) report.budget = budget_report(*checked.planned.budget);
  const std::size_t shown = std::min(kOrderShown, checked.planned.order.size());
  report.order.assign(checked.planned.order.begin(),
                      checked.planned.order.begin() + static_cast<std::ptrdiff_t>(shown));
  const auto& alone = checked.planned.without_partner;
  report.out_of_reach = checked.planned.out_of_reach;
  report.without_partner.assign(alone.begin(),
                                alone.begin() + static_cast<std::ptrdiff_t>(std::min(kOrderShown, alone.size())));
  add_outlook(report, checked, instrument);
  return report;
}

}  // namespace

DaemonService::DaemonService(Parts parts) : parts_(std::move(parts)), started_(parts_.clock.now()) {}

template <class Ask>
auto DaemonService::ask_store(Ask ask) -> decltype(ask(std::declval<StoreReader&>())) {
  std::unique_ptr<StoreReader> reader;
  {
    const std::lock_guard lock(mutex_);
    if (!readers_.empty()) {
      reader = std::move(readers_.back());
      readers_.pop_back();
    }
  }
  if (!reader) {
    Result<std::unique_ptr<StoreReader>> opened = StoreReader::open(parts_.store_file);
    if (!opened) return failure(opened.error());
    reader = std::move(*opened);
  }
  auto answer = ask(*reader);
  const std::lock_guard lock(mutex_);
  readers_.push_back(std::move(reader));
  return answer;
}

void DaemonService::stop(const std::string& who, Reply<api::StopReport> reply) {
  parts_.engine.stop(who, [reply = std::move(reply)](const Result<drivers::Epoch>& epoch) {
    reply(epoch ? Result<api::StopReport>(api::StopReport{.epoch = *epoch}) : failure(epoch.error()));
  });
}

void DaemonService::command(const std::string& who, Verb verb, Reply<api::CommandReport> reply) {
  parts_.engine.command(who, std::move(verb), [reply = std::move(reply)](const Result<CommandDone>& done) {
    if (!done) return reply(failure(done.error()));
    reply(api::CommandReport{.scan = done->scan, .existed = done->existed, .note = done->note});
  });
}

void DaemonService::move_stage(const api::MoveRequest& request, const std::string& who,
                               Reply<api::CommandReport> reply) {
  command(who,
          MoveStage{.target = target_of(request),
                    .source_shutter_open = request.source_shutter_open,
                    .detector_shutter_open = request.detector_shutter_open},
          std::move(reply));
}

void DaemonService::home_stage(const std::string& who, Reply<api::CommandReport> reply) {
  command(who, HomeStage{}, std::move(reply));
}

void DaemonService::reset_stage(const std::string& who, Reply<api::CommandReport> reply) {
  command(who, ClearStage{}, std::move(reply));
}

void DaemonService::read_detector(const api::DetectorReadRequest& request, const std::string& who,
                                  Reply<api::DetectorReading> reply) {
  const auto verb = reading_verb(request);
  if (!verb) return reply(failure(verb.error()));
  parts_.engine.command(who, *verb, [reply = std::move(reply)](const Result<CommandDone>& done) {
    if (!done) return reply(failure(done.error()));
    reply(reading_report(*done->reading));
  });
}

void DaemonService::submit_scan(const api::PlanSubmission& submission, const std::string& idempotency_key,
                                const std::string& who, Reply<api::CommandReport> reply) {
  if (const auto allowed = check_priority(submission.priority); !allowed) return reply(failure(allowed.error()));
  const auto start = start_from(submission.start_utc);
  if (!start) return reply(failure(start.error()));
  Result<CheckedPlan> checked = checked_plan(submission);
  if (!checked) return reply(failure(checked.error()));
  NewScan scan = new_scan(std::move(*checked), submission, idempotency_key, who, parts_.instrument);
  scan.turn = {.priority = submission.priority, .preempts = submission.preempt, .start = *start};
  command(who, SubmitScan{std::move(scan)}, std::move(reply));
}

void DaemonService::change_scan(std::int64_t scan, ScanVerb verb, const std::string& reason, const std::string& who,
                                Reply<api::CommandReport> reply) {
  if (const auto error = is_over_for(scan, ask_of(verb))) return reply(failure(*error));
  command(who, verb_of(scan, verb, reason), std::move(reply));
}

void DaemonService::resume_scan(std::int64_t scan, const api::ResumeRequest& request, const std::string& who,
                                Reply<api::CommandReport> reply) {
  ResumeScan resume{.scan = scan};
  if (!request.hold.empty()) {
    resume.hold = hold_from_name(request.hold);
    if (!resume.hold) {
      return reply(failure(no_such("hold", request.hold, "operator, lamp, door, device, disk, restart, preempted")));
    }
  }
  if (const auto error = is_over_for(scan, ScanAsk::Resume)) return reply(failure(*error));
  command(who, resume, std::move(reply));
}

void DaemonService::change_rest(std::int64_t scan, const api::ChangeRequest& request, const std::string& who,
                                Reply<api::CommandReport> reply) {
  Result<ChangeScan> change = change_of(scan, request);
  if (!change) return reply(failure(change.error()));
  const auto start = start_from(request.start_utc.value_or(""));
  if (!start) return reply(failure(start.error()));
  change->start = *start;
  if (const auto error = is_over_for(scan, ScanAsk::Change)) return reply(failure(*error));
  if (change->order == RestOrder::Fastest) {
    auto found = ask_store([&](StoreReader& store) { return fastest_rest(store, scan, parts_.instrument); });
    if (!found) return reply(failure(found.error()));
    change->fastest = std::move(*found);
  }
  command(who, std::move(*change), std::move(reply));
}

void DaemonService::complete_missing(std::int64_t scan, const std::string& who, Reply<api::CommandReport> reply) {
  Result<NewScan> missing = ask_store([&](StoreReader& store) {
    return completion_of(store, scan, parts_.instrument, parts_.shelf, parts_.clock.utc_now(), who);
  });
  if (!missing) return reply(failure(missing.error()));
  command(who, SubmitScan{std::move(*missing)}, std::move(reply));
}

void DaemonService::use_calibration(std::int64_t version, const api::UseCalibrationRequest& request,
                                    const std::string& who, Reply<api::CommandReport> reply) {
  const auto found = ask_store([version](StoreReader& store) { return found_version(store, version); });
  if (!found) return reply(failure(found.error()));
  if (!changes_scans(found->job)) {
    return reply(failure({.code = ErrorCode::InvalidInput,
                          .device = "calibration",
                          .tried = fmt::format("use calibration {}", version),
                          .seen = "its job, " + found->job + ", changes no scan",
                          .limit = makes_maps(found->job) ? "gonioctl calibration maps writes its files: named in "
                                                            "[detector.maps], they count from goniod's next start on"
                                                          : "gonioctl calibration show says what it found"}));
  }
  command(who, UseCalibration{.version = version, .in_use = request.in_use, .reason = request.reason},
          std::move(reply));
}

// Computed once to refuse at once what cannot be; what is stored is computed when the command is durable.
void DaemonService::recompute_scan(std::int64_t scan, const api::RecomputeRequest& request, const std::string& who,
                                   Reply<api::CommandReport> reply) {
  const Result<AskedVersions> asked = asked_versions_from(request.calibration);
  if (!asked) return reply(failure(asked.error()));
  const auto brdf = ask_store([&](StoreReader& store) { return compute_brdf(store, scan, *asked); });
  if (!brdf) return reply(failure(brdf.error()));
  command(who, RecomputeScan{.scan = scan, .versions = *asked}, std::move(reply));
}

std::optional<Error> DaemonService::is_over_for(std::int64_t scan, ScanAsk ask) {
  const Result<ScanInfo> info = ask_store([scan](StoreReader& store) { return store.scan(scan); });
  if (!info) return info.error().code == ErrorCode::NotFound ? std::optional(info.error()) : std::nullopt;
  if (!is_over(info->state)) return std::nullopt;
  return not_now(scan, info->state, false, ask);
}

// Kept as a moment of this boot: a step of the clock meanwhile does not move it.
Result<std::optional<ScanTurn::Start>> DaemonService::start_from(const std::string& text) const {
  if (text.empty()) return std::optional<ScanTurn::Start>();
  const auto utc = utc_from_iso8601(text);
  if (!utc) return failure(no_such("start_utc", text, "a time in UTC, as 2026-11-22T18:05Z"));
  return std::optional(ScanTurn::Start{.at = parts_.clock.now() + (*utc - parts_.clock.utc_now()), .utc = *utc});
}

Result<api::StatusReport> DaemonService::status() {
  const Instant now = parts_.clock.now();
  const SequencerStatus sequencer = parts_.engine.status();
  const Result<std::int64_t> last = ask_store([](StoreReader& store) { return store.last_event(); });
  if (!last) return failure(last.error());
  api::StatusReport report{.version = parts_.version,
                           .instrument = parts_.instrument.name,
                           .instrument_sha256 = parts_.instrument.sha256,
                           .uptime_s = in_seconds(now - started_),
                           .doing = sequencer.doing,
                           .stage_stopped = sequencer.stage_stopped,
                           .queued = sequencer.queued,
                           .aside = sequencer.aside,
                           .stage_error = parts_.engine.stage().error(),
                           .detector_error = parts_.engine.detector_error(),
                           .store_error = sequencer.store_error,
                           .last_event = *last};
  if (sequencer.warm_up) report.warm_up = warm_up_report(*sequencer.warm_up);
  if (const auto state = parts_.engine.stage().value()) report.stage = stage_report(*state, now);
  if (sequencer.active) {
    const Result<ScanInfo> info = ask_store([&](StoreReader& store) { return store.scan(sequencer.active->scan); });
    if (!info) return failure(info.error());
    report.active = scan_report(*info, now);
    add_progress(*report.active, sequencer, now);
  }
  return report;
}

api::HealthReport DaemonService::health() {
  return {.ok = !parts_.engine.status().store_error && !parts_.engine.stage().error(), .version = parts_.version};
}

std::string DaemonService::metrics() {
  const SequencerStatus status = parts_.engine.status();
  std::string text = fmt::format("# TYPE goniod_info gauge\ngoniod_info{{version=\"{}\"}} 1\n", parts_.version);
  const auto gauge = [&](std::string_view name, auto value) {
    text += fmt::format("# TYPE goniod_{0} gauge\ngoniod_{0} {1}\n", name, value);
  };
  gauge("uptime_seconds", in_seconds(parts_.clock.now() - started_));
  gauge("stage_stopped", status.stage_stopped ? 1 : 0);
  gauge("stage_failing", parts_.engine.stage().error() ? 1 : 0);
  gauge("detector_failing", parts_.engine.detector_error() ? 1 : 0);
  gauge("store_failing", status.store_error ? 1 : 0);
  gauge("scans_queued", status.queued.size());
  if (status.active) {
    gauge("scan_items", status.active->items);
    gauge("scan_items_accepted", status.active->accepted);
    gauge("scan_items_skipped", status.active->skipped);
    gauge("scan_holds", status.active->holds.size());
  }
  return text;
}

Result<api::StageReport> DaemonService::stage() {
  const std::optional<Error> error = parts_.engine.stage().error();
  if (error) return failure(*error);
  const std::optional<drivers::StageState> state = parts_.engine.stage().value();
  if (state) return stage_report(*state, parts_.clock.now());
  return failure({.code = ErrorCode::Unreachable,
                  .device = "stage",
                  .tried = "show where it is",
                  .seen = "it has not answered yet",
                  .limit = {}});
}

Result<api::PlanReport> DaemonService::check_plan(const api::PlanSubmission& submission) {
  const Result<CheckedPlan> checked = checked_plan(submission);
  if (!checked) return failure(checked.error());
  const Result<Instrument> known = ask_store([this](StoreReader& store) { return as_known(parts_.instrument, store); });
  if (!known) return failure(known.error());
  return plan_report(*checked, *known);
}

// A store that cannot be read teaches nothing; the plan is checked all the same.
Result<CheckedPlan> DaemonService::checked_plan(const api::PlanSubmission& submission) {
  const Result<TimeExperience> learned =
      ask_store([this](StoreReader& store) { return store.time_experience(parts_.instrument.sha256); });
  return daemon::check_plan(submission, parts_.instrument, parts_.shelf, parts_.clock.utc_now(),
                            learned.value_or(TimeExperience{}));
}

Result<api::ScanList> DaemonService::scans() {
  const Result<std::vector<ScanInfo>> infos = ask_store([](StoreReader& store) { return store.scans(0, kScansShown); });
  if (!infos) return failure(infos.error());
  const Instant now = parts_.clock.now();
  const SequencerStatus sequencer = parts_.engine.status();
  api::ScanList list;
  for (const ScanInfo& info : *infos) {
    list.scans.push_back(scan_report(info, now));
    add_progress(list.scans.back(), sequencer, now);
  }
  return list;
}

Result<api::ScanReport> DaemonService::scan(std::int64_t scan) {
  const Result<ScanInfo> info = ask_store([scan](StoreReader& store) { return store.scan(scan); });
  if (!info) return failure(info.error());
  const Instant now = parts_.clock.now();
  api::ScanReport report = scan_report(*info, now);
  add_progress(report, parts_.engine.status(), now);
  const Result<ScanTexts> texts = ask_store([scan](StoreReader& store) { return store.texts(scan); });
  if (!texts) return failure(texts.error());
  report.plan = texts->plan;
  report.plan_file = texts->plan_file;
  report.plan_parts = texts->plan_parts;
  if (!is_over(info->state)) return report;
  const Result<BrdfInfo> brdf = ask_store([scan](StoreReader& store) { return brdf_of(store, scan); });
  if (!brdf) return report;  // the scan is there all the same; GET brdf says why it has no values
  const RelativeUncertainty u = relative_uncertainty(*brdf);
  report.brdf_values = u.values;
  report.calibrations = version_list_text(brdf->versions);
  report.median_relative_u = u.median;
  report.worst_relative_u = u.worst;
  report.checks = checks_in_short(scan, brdf->calibration);
  return report;
}

std::optional<std::string> DaemonService::checks_in_short(ScanId scan, std::int64_t calibration) {
  constexpr std::size_t kRemembered = 10'000;
  {
    const std::lock_guard lock(mutex_);
    const auto known = checks_.find({scan, calibration});
    if (known != checks_.end()) return known->second;
  }
  const Result<api::ScanChecksReport> found = checks(scan);
  if (!found) return std::nullopt;  // the summary stands without them; GET checks says why
  const std::lock_guard lock(mutex_);
  if (calibration != 0 && checks_.size() < kRemembered) checks_[{scan, calibration}] = found->summary;
  return found->summary;
}

Result<api::ScanChecksReport> DaemonService::checks(std::int64_t scan) {
  return ask_store([scan](StoreReader& store) { return checks_of(store, scan); });
}

Result<api::PointBudgetReport> DaemonService::budget(std::int64_t scan, std::optional<std::int64_t> point) {
  return ask_store([&](StoreReader& store) { return budget_of_point(store, scan, point); });
}

Result<api::PointPage> DaemonService::points(std::int64_t scan, std::int64_t after, int at_most) {
  const auto from = static_cast<std::int32_t>(std::clamp<std::int64_t>(after, -1, INT32_MAX));
  const Result<std::vector<PointInfo>> infos =
      ask_store([&](StoreReader& store) { return store.points(scan, from, at_most); });
  if (!infos) return failure(infos.error());
  api::PointPage page;
  for (const PointInfo& info : *infos) page.points.push_back(point_report(info));
  if (std::ssize(page.points) == at_most) page.next_after = page.points.back().index;
  return page;
}

Result<api::BrdfPage> DaemonService::brdf(std::int64_t scan, std::int64_t after, int at_most) {
  const auto all = ask_store([scan](StoreReader& store) { return results_of(store, scan); });
  if (!all) return failure(all.error());
  api::BrdfPage page;
  for (const api::BrdfReport& value : *all) {
    if (value.point > after && std::ssize(page.values) < at_most) page.values.push_back(value);
  }
  if (std::ssize(page.values) == at_most) page.next_after = page.values.back().point;
  return page;
}

Result<std::string> DaemonService::export_csv(std::int64_t scan) {
  return ask_store([&](StoreReader& store) { return daemon::export_csv(store, scan, "goniod " + parts_.version); });
}

Result<api::ReferenceList> DaemonService::references() {
  api::ReferenceList list;
  for (const ShelfEntry& entry : parts_.shelf.all()) list.references.push_back(reference_report(entry));
  return list;
}

Result<api::CalibrationList> DaemonService::calibrations() {
  const auto found = ask_store([](StoreReader& store) { return store.found_calibrations(); });
  if (!found) return failure(found.error());
  api::CalibrationList list;
  for (auto one = found->rbegin(); one != found->rend(); ++one) {
    list.calibrations.push_back(calibration_report(*one));
  }
  return list;
}

Result<api::CalibrationReport> DaemonService::calibration(std::int64_t version) {
  const auto found = ask_store([version](StoreReader& store) { return found_version(store, version); });
  if (!found) return failure(found.error());
  return calibration_report(*found);
}

Result<std::string> DaemonService::calibration_map(std::int64_t version, const std::string& name) {
  return ask_store([&](StoreReader& store) { return map_file_of(store, version, name); });
}

Result<api::ChartReport> DaemonService::calibration_chart(const std::string& standard) {
  return ask_store([&](StoreReader& store) { return chart_of(store, standard); });
}

Result<api::ReferenceReport> DaemonService::reference(const std::string& serial) {
  return reference_in_full(parts_.shelf, serial);
}

Result<api::ReferenceReport> DaemonService::check_reference(const api::ReferenceImport& request) {
  return check_import(request, parts_.shelf);
}

Result<api::ReferenceReport> DaemonService::import_reference(const api::ReferenceImport& request,
                                                             const std::string& who) {
  Result<api::ReferenceReport> report = import_to_shelf(request, parts_.shelf, parts_.clock.utc_now());
  if (report) log_info(fmt::format("reference: {} imported by {}: {}", report->serial, who, report->note));
  return report;
}

api::InstrumentReport DaemonService::instrument() {
  return instrument_report(parts_.instrument, parts_.store_file);
}

Result<api::AnalysisReport> DaemonService::start_analysis(const api::AnalysisRequest& request, const std::string& who) {
  const Result<ScanInfo> scan = ask_store([&](StoreReader& store) { return store.scan(request.scan); });
  if (!scan && request.scan > 0) return failure(scan.error());
  return parts_.analyses.start(request, who);
}

Result<std::vector<api::Event>> DaemonService::events(std::int64_t after, int at_most) {
  const auto records = ask_store([&](StoreReader& store) { return store.events(after, at_most, 0); });
  if (!records) return failure(records.error());
  std::vector<api::Event> events;
  for (const EventRecord& record : *records) events.push_back(event_report(record));
  return events;
}

}  // namespace gonio::daemon
