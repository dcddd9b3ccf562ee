#include "daemon/tape/tape_input.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "daemon/planner/planner.h"
#include "protocol/api/plan.h"

namespace gonio::daemon {
namespace {

using nlohmann::json;

constexpr const char* kCommand = "command";
constexpr const char* kStop = "stop";
constexpr const char* kDisk = "disk";

json numbers_of(const drivers::MotionTarget& target) {
  json numbers = json::array();
  for (const std::optional<double>& wanted : target) numbers.push_back(wanted ? json(*wanted) : json());
  return numbers;
}

template <class T>
json or_null(const std::optional<T>& value) {
  return value ? json(*value) : json();
}

json json_of(const std::optional<ScanTurn::Start>& start) {
  if (!start) return {};
  return {{"at_ns", start->at.time_since_epoch().count()}, {"utc_ns", start->utc.time_since_epoch().count()}};
}

std::optional<ScanTurn::Start> start_from(const json& words) {
  if (!words.is_object()) return std::nullopt;
  return ScanTurn::Start{.at = Instant(Duration(words.at("at_ns").get<std::int64_t>())),
                         .utc = UtcTime(Duration(words.at("utc_ns").get<std::int64_t>()))};
}

// A completion's points are no plan's: they stand for themselves, as do its name and what it goes by.
json points_of(const PlannedScan& planned) {
  json points = json::array();
  for (const ScanPoint& point : planned.points) {
    const Geometry& g = point.geometry;
    points.push_back(
        {point.rank, g.theta_i.si(), g.phi_i.si(), g.theta_r.si(), g.phi_r.si(), point.wavelength.si(), point.repeat});
  }
  return points;
}

// What the store had taught the prediction: another store has other scans behind it.
json json_of(const TimeExperience& experience) {
  json white = json::array();
  for (const WhiteSignal& one : experience.white) white.push_back({one.wavelength.si(), one.dn_per_s});
  return {{"scans", experience.scans},
          {"motion", {experience.motion.value, experience.motion.u}},
          {"beyond_s", {experience.beyond_s.value, experience.beyond_s.u}},
          {"white", white}};
}

// Earlier tapes name none.
TimeExperience experience_from(const json& words) {
  TimeExperience experience;
  if (!words.is_object()) return experience;
  experience.scans = words.at("scans");
  experience.motion = {words.at("motion").at(0), words.at("motion").at(1)};
  experience.beyond_s = {words.at("beyond_s").at(0), words.at("beyond_s").at(1)};
  for (const json& one : words.at("white")) {
    experience.white.push_back({Wavelength::from_si(one.at(0)), one.at(1)});
  }
  return experience;
}

json json_of(const SubmitScan& verb) {
  const NewScan& scan = verb.scan;
  json words{{"verb", "submit"},
             {"key", scan.idempotency_key},
             {"campaign", scan.campaign},
             {"plan", scan.plan_text},
             {"plan_file", scan.plan_file},
             {"plan_parts", scan.plan_parts},
             {"reference", scan.reference_text},
             {"reference_serial", scan.reference_serial},
             {"submitted_by", scan.who},
             {"experience", json_of(scan.planned.experience)},
             {"turn",
              {{"priority", scan.turn.priority},
               {"preempts", scan.turn.preempts},
               {"start", json_of(scan.turn.start)},
               {"completes", scan.turn.completes}}}};
  if (scan.turn.completes != 0) {
    words["completion"] = {{"points", points_of(scan.planned)},
                           {"target_snr", scan.policy.target_snr},
                           {"max_time_ns", scan.policy.max_time.count()}};
  }
  return words;
}
json json_of(const PauseScan& verb) {
  return {{"verb", "pause"}, {"scan", verb.scan}, {"now", verb.now}, {"reason", verb.reason}};
}
json json_of(const ResumeScan& verb) {
  return {{"verb", "resume"}, {"scan", verb.scan}, {"hold", verb.hold ? json(hold_name(*verb.hold)) : json()}};
}
json json_of(const FinishScan& verb) {
  return {{"verb", "finish"}, {"scan", verb.scan}};
}
json json_of(const AbortScan& verb) {
  return {{"verb", "abort"}, {"scan", verb.scan}, {"reason", verb.reason}};
}
json json_of(const SkipItemInHand& verb) {
  return {{"verb", "skip"}, {"scan", verb.scan}};
}
json json_of(const MoveStage& verb) {
  return {{"verb", "move"},
          {"target", numbers_of(verb.target)},
          {"source_shutter_open", or_null(verb.source_shutter_open)},
          {"detector_shutter_open", or_null(verb.detector_shutter_open)}};
}
json json_of(const HomeStage& /*verb*/) {
  return {{"verb", "home"}};
}
json json_of(const ClearStage& /*verb*/) {
  return {{"verb", "reset"}};
}
json json_of(const ChangeScan& verb) {
  return {{"verb", "change"},
          {"scan", verb.scan},
          {"target_snr", or_null(verb.target_snr)},
          {"max_time_ns", verb.max_time ? json(verb.max_time->count()) : json()},
          {"order", verb.order ? json(rest_order_name(*verb.order)) : json()},
          {"seed", verb.seed},
          {"fastest", verb.fastest},
          {"priority", or_null(verb.priority)},
          {"start", json_of(verb.start)},
          {"reason", verb.reason}};
}

json json_of(const ReadDetector& verb) {
  return {{"verb", "read"},
          {"exposure_ns", verb.exposure ? json(verb.exposure->count()) : json()},
          {"range_w", or_null(verb.range_w)},
          {"lit", or_null(verb.lit)}};
}

json json_of(const UseCalibration& verb) {
  return {{"verb", "use-calibration"}, {"version", verb.version}, {"in_use", verb.in_use}, {"reason", verb.reason}};
}
json json_of(const RecomputeScan& verb) {
  return {{"verb", "recompute"}, {"scan", verb.scan}, {"versions", or_null(verb.versions)}};
}

template <class T>
std::optional<T> optional_of(const json& value) {
  if (value.is_null()) return std::nullopt;
  return value.get<T>();
}

void read_turn(const json& words, NewScan& scan) {
  scan.turn = {.priority = words.at("priority"),
               .preempts = words.at("preempts"),
               .start = start_from(words.at("start")),
               .completes = words.at("completes")};
}

PlannedScan points_from(const json& words) {
  PlannedScan planned{.planner_version = kPlannerVersion};
  for (const json& one : words) {
    ScanPoint point{.index = static_cast<std::int32_t>(planned.points.size()), .rank = one.at(0)};
    point.geometry = {.theta_i = Angle::from_si(one.at(1)),
                      .phi_i = Angle::from_si(one.at(2)),
                      .theta_r = Angle::from_si(one.at(3)),
                      .phi_r = Angle::from_si(one.at(4))};
    point.wavelength = Wavelength::from_si(one.at(5));
    point.repeat = one.at(6);
    planned.points.push_back(point);
  }
  planned.order.resize(planned.points.size());
  for (const ScanPoint& point : planned.points) planned.order.at(static_cast<std::size_t>(point.rank)) = point.index;
  planned.asked = std::ssize(planned.points);
  return planned;
}

void read_completion(const json& words, NewScan& scan) {
  scan.planned = points_from(words.at("points"));
  scan.planned.items = items_of(scan.planned.asked, scan.policy.reference_mode);
  scan.policy.target_snr = words.at("target_snr");
  scan.policy.max_time = Duration(words.at("max_time_ns").get<std::int64_t>());
}

Result<Verb> submitted(const json& words, const Instrument& instrument) {
  SubmitScan submit;
  NewScan& scan = submit.scan;
  scan.idempotency_key = words.at("key");
  scan.campaign = words.at("campaign");
  scan.plan_text = words.at("plan");
  scan.plan_file = words.at("plan_file");
  scan.plan_parts = words.value("plan_parts", scan.plan_parts);
  scan.reference_text = words.at("reference");
  scan.reference_serial = words.at("reference_serial");
  scan.who = words.at("submitted_by");
  const Result<api::Plan> plan = api::parse_plan(scan.plan_text, scan.plan_file, scan.plan_parts);
  if (!plan) return failure(plan.error());
  Result<PlannedScan> planned = expand(*plan, instrument, experience_from(words.value("experience", json())));
  if (!planned) return failure(std::move(planned).error());
  scan.name = plan->name;
  scan.sample = plan->sample;
  scan.isotropic = plan->isotropic;
  scan.planned = std::move(*planned);
  scan.policy = policy_of(*plan, scan.planned);
  scan.instrument_text = instrument.text;
  scan.instrument_hash = instrument.sha256;
  if (words.contains("turn")) read_turn(words.at("turn"), scan);
  if (words.contains("completion")) read_completion(words.at("completion"), scan);
  return submit;
}

ChangeScan change_of(const json& words) {
  ChangeScan change{.scan = words.at("scan"), .seed = words.at("seed"), .reason = words.at("reason")};
  change.target_snr = optional_of<double>(words.at("target_snr"));
  if (const auto ns = optional_of<std::int64_t>(words.at("max_time_ns"))) change.max_time = Duration(*ns);
  if (const auto order = optional_of<std::string>(words.at("order"))) change.order = rest_order_from_name(*order);
  change.fastest = words.value("fastest", change.fastest);  // earlier tapes have none
  change.priority = optional_of<int>(words.at("priority"));
  change.start = start_from(words.at("start"));
  return change;
}

ResumeScan resume_of(const json& words) {
  ResumeScan resume{.scan = words.at("scan")};
  // Earlier tapes name no hold.
  if (const auto hold = optional_of<std::string>(words.value("hold", json()))) resume.hold = hold_from_name(*hold);
  return resume;
}

MoveStage move_of(const json& words) {
  MoveStage move;
  const json& target = words.at("target");
  for (std::size_t axis = 0; axis < move.target.size() && axis < target.size(); ++axis) {
    move.target[axis] = optional_of<double>(target[axis]);
  }
  move.source_shutter_open = optional_of<bool>(words.at("source_shutter_open"));
  move.detector_shutter_open = optional_of<bool>(words.at("detector_shutter_open"));
  return move;
}

ReadDetector reading_of(const json& words) {
  ReadDetector read;
  if (const auto ns = optional_of<std::int64_t>(words.at("exposure_ns"))) read.exposure = Duration(*ns);
  read.range_w = optional_of<double>(words.at("range_w"));
  read.lit = optional_of<bool>(words.at("lit"));
  return read;
}

Result<Verb> verb_of(const json& words, const Instrument& instrument) {
  const std::string verb = words.at("verb");
  if (verb == "submit") return submitted(words, instrument);
  if (verb == "pause") {
    return PauseScan{.scan = words.at("scan"), .now = words.at("now"), .reason = words.at("reason")};
  }
  if (verb == "resume") return resume_of(words);
  if (verb == "change") return change_of(words);
  if (verb == "finish") return FinishScan{.scan = words.at("scan")};
  if (verb == "abort") return AbortScan{.scan = words.at("scan"), .reason = words.at("reason")};
  if (verb == "skip") return SkipItemInHand{.scan = words.at("scan")};
  if (verb == "move") return move_of(words);
  if (verb == "home") return HomeStage{};
  if (verb == "reset") return ClearStage{};
  if (verb == "read") return reading_of(words);
  if (verb == "use-calibration") {
    return UseCalibration{.version = words.at("version"), .in_use = words.at("in_use"), .reason = words.at("reason")};
  }
  if (verb == "recompute") {
    return RecomputeScan{.scan = words.at("scan"),
                         .versions = optional_of<std::vector<CalibrationVersion>>(words.at("versions"))};
  }
  return failure({.code = ErrorCode::InvalidInput,
                  .device = "tape",
                  .tried = "take a command",
                  .seen = "\"" + verb + "\", which this version does not know",
                  .limit = {}});
}

Result<SequencerMessage> read_message(const drivers::TapeInput& input, const Instrument& instrument) {
  const json words = json::parse(input.text);
  if (input.kind == kDisk) return DiskSeen{.free_bytes = words.at("free_bytes")};
  if (input.kind == kStop) return StopHappened{.epoch = words.at("epoch"), .who = words.at("who")};
  Result<Verb> verb = verb_of(words, instrument);
  if (!verb) return failure(std::move(verb).error());
  return Command{.id = words.at("id"), .who = words.at("who"), .verb = std::move(*verb)};
}

}  // namespace

std::optional<drivers::TapeInput> tape_input_of(const SequencerMessage& message) {
  if (const auto* command = std::get_if<Command>(&message)) {
    json words = std::visit([](const auto& verb) { return json_of(verb); }, command->verb);
    words["id"] = command->id;
    words["who"] = command->who;
    return drivers::TapeInput{.kind = kCommand, .text = words.dump()};
  }
  if (const auto* stop = std::get_if<StopHappened>(&message)) {
    return drivers::TapeInput{.kind = kStop, .text = json{{"epoch", stop->epoch}, {"who", stop->who}}.dump()};
  }
  if (const auto* disk = std::get_if<DiskSeen>(&message)) {
    return drivers::TapeInput{.kind = kDisk, .text = json{{"free_bytes", disk->free_bytes}}.dump()};
  }
  return std::nullopt;
}

Result<SequencerMessage> message_of(const drivers::TapeInput& input, const Instrument& instrument) try {
  return read_message(input, instrument);
} catch (const json::exception& e) {
  return failure({.code = ErrorCode::InvalidInput,
                  .device = "tape",
                  .tried = "take a " + input.kind,
                  .seen = e.what(),
                  .limit = {}});
}

}  // namespace gonio::daemon
