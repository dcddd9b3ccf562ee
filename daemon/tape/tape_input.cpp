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

json numbers_of(const drivers::MotionTarget& target) {
  json numbers = json::array();
  for (const std::optional<double>& wanted : target) numbers.push_back(wanted ? json(*wanted) : json());
  return numbers;
}

template <class T>
json or_null(const std::optional<T>& value) {
  return value ? json(*value) : json();
}

json json_of(const SubmitScan& verb) {
  const NewScan& scan = verb.scan;
  return {{"verb", "submit"},
          {"key", scan.idempotency_key},
          {"campaign", scan.campaign},
          {"plan", scan.plan_text},
          {"plan_file", scan.plan_file},
          {"plan_parts", scan.plan_parts},
          {"reference", scan.reference_text},
          {"reference_serial", scan.reference_serial},
          {"submitted_by", scan.who}};
}
json json_of(const PauseScan& verb) {
  return {{"verb", "pause"}, {"scan", verb.scan}, {"now", verb.now}, {"reason", verb.reason}};
}
json json_of(const ResumeScan& verb) {
  return {{"verb", "resume"}, {"scan", verb.scan}};
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

json json_of(const ReadDetector& verb) {
  return {{"verb", "read"},
          {"exposure_ns", verb.exposure ? json(verb.exposure->count()) : json()},
          {"range_w", or_null(verb.range_w)},
          {"lit", or_null(verb.lit)}};
}

template <class T>
std::optional<T> optional_of(const json& value) {
  if (value.is_null()) return std::nullopt;
  return value.get<T>();
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
  Result<PlannedScan> planned = expand(*plan, instrument);
  if (!planned) return failure(std::move(planned).error());
  scan.name = plan->name;
  scan.sample = plan->sample;
  scan.isotropic = plan->isotropic;
  scan.policy = policy_of(*plan);
  scan.instrument_text = instrument.text;
  scan.instrument_hash = instrument.sha256;
  scan.planned = std::move(*planned);
  return submit;
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
  if (verb == "resume") return ResumeScan{.scan = words.at("scan")};
  if (verb == "finish") return FinishScan{.scan = words.at("scan")};
  if (verb == "abort") return AbortScan{.scan = words.at("scan"), .reason = words.at("reason")};
  if (verb == "skip") return SkipItemInHand{.scan = words.at("scan")};
  if (verb == "move") return move_of(words);
  if (verb == "home") return HomeStage{};
  if (verb == "reset") return ClearStage{};
  if (verb == "read") return reading_of(words);
  return failure({.code = ErrorCode::InvalidInput,
                  .device = "tape",
                  .tried = "take a command",
                  .seen = "\"" + verb + "\", which this version does not know",
                  .limit = {}});
}

Result<SequencerMessage> read_message(const drivers::TapeInput& input, const Instrument& instrument) {
  const json words = json::parse(input.text);
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
