#include "daemon/app/engine.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "daemon/app/log.h"
#include "daemon/desks/event_sentence.h"
#include "daemon/results/calibration_desk.h"
#include "daemon/results/job_desk.h"
#include "daemon/tape/tape_input.h"

namespace gonio::daemon {
namespace {

constexpr std::size_t kMailbox = 1024;
constexpr std::size_t kMostScansToCompute = 256;

// A promise of our own was broken: whatever moves is stopped by the stage's watch once this process has gone.
void on_bug(const std::string& what) {
  log_error("a thread broke a promise and the daemon ends: " + what);
  std::abort();
}

// Whether the stage could not be seen at all; a refused or stopped motion is an answer like any other.
bool is_of_the_link(const Error& error) {
  const ErrorCode code = error.code;
  return code == ErrorCode::Unreachable || code == ErrorCode::TimedOut || code == ErrorCode::BadReply ||
         code == ErrorCode::WrongDevice;
}

bool asks_for_brdf(const EventRecord& event) {
  return event.kind == "scan-done" || event.kind == "scan-finished-early" || event.kind == "recompute-asked";
}

}  // namespace

Engine::Engine(Config config, EngineDevices devices, StoreWriter& writer, const Clock& clock, OnEvent on_event)
    : config_(std::move(config)),
      writer_(writer),
      clock_(clock),
      on_event_(std::move(on_event)),
      turn_now_(config_.by_hand_from.value_or(Instant{})),
      sequencer_turns_(turns_of(drivers::TapeParty::Sequencer)),
      to_sequencer_(kMailbox, config_.by_hand_from.has_value()),
      halt_(devices.halt_line, clock, HaltPathConfig{.heartbeat_timeout = config_.instrument.stage.heartbeat_timeout},
            [this](const HaltPathReport& report) { on_halt(report); }),
      stage_actor_(devices.stage, config_.instrument.stage, [this](const StageAnswer& answer) { on_stage(answer); }),
      store_desk_(*this),
      calibrator_(std::make_unique<Worker>(kMostScansToCompute)) {
  store_thread_ = std::make_unique<ActorThread<StoreDesk, StoreRequest>>("store", store_desk_, clock_, kMailbox, on_bug,
                                                                         turns_of(drivers::TapeParty::Store));
  stage_thread_ = std::make_unique<ActorThread<StageActor, StageRequest>>("stage", stage_actor_, clock_, kMailbox,
                                                                          on_bug, turns_of(drivers::TapeParty::Stage));
  make_detector(devices);
  desk_ = std::make_unique<SequencerDesk>(SequencerConfig{.instrument = config_.instrument, .epoch = halt_.epoch()},
                                          ports(), now());
  if (config_.by_hand_from) return;
  // A tape begins with an empty store.
  if (config_.tape == nullptr) (void)calibrator_->post([this] { compute_what_is_missing(); });
  sequencer_thread_ = std::thread([this] { run_sequencer(); });
  pthread_setname_np(sequencer_thread_.native_handle(), "sequencer");
}

Engine::~Engine() {
  to_sequencer_.close();
  if (sequencer_thread_.joinable()) sequencer_thread_.join();
  calibrator_.reset();
  if (camera_thread_) camera_thread_->stop();
  if (radiometer_thread_) radiometer_thread_->stop();
  if (monitor_thread_) monitor_thread_->stop();
  stage_thread_->stop();
  store_thread_->stop();
}

void Engine::make_detector(const EngineDevices& devices) {
  const Instrument& instrument = config_.instrument;
  const auto answer = [this](DetectorActor::Answer a) { on_detector(std::move(a)); };
  if (devices.radiometer != nullptr && instrument.detector.power) {
    radiometer_actor_ = std::make_unique<RadiometerActor>(*devices.radiometer, *instrument.detector.power, answer);
    radiometer_thread_ = std::make_unique<ActorThread<RadiometerActor, DetectorRequest>>(
        "detector", *radiometer_actor_, clock_, kMailbox, on_bug, turns_of(drivers::TapeParty::Detector));
  } else {
    camera_actor_ = std::make_unique<DetectorActor>(
        *devices.camera, FrameReduction{instrument.detector.aperture, instrument.maps, instrument.model.detector},
        answer);
    camera_thread_ = std::make_unique<ActorThread<DetectorActor, DetectorRequest>>(
        "detector", *camera_actor_, clock_, kMailbox, on_bug, turns_of(drivers::TapeParty::Detector));
  }
  if (devices.monitor == nullptr || !instrument.monitor) return;
  monitor_actor_ = std::make_unique<MonitorActor>(*devices.monitor, *instrument.monitor,
                                                  [this](MonitorActor::Answer a) { on_monitor(std::move(a)); });
  monitor_thread_ = std::make_unique<ActorThread<MonitorActor, MonitorRequest>>(
      "monitor", *monitor_actor_, clock_, kMailbox, on_bug, turns_of(drivers::TapeParty::Monitor));
}

void Engine::stop(const std::string& who, std::function<void(Result<drivers::Epoch>)> done) {
  // Noted before: the halt may be acknowledged before `stop` has returned. The one that comes has at least this number.
  stops_.add(halt_.epoch() + 1U, std::move(done));
  halt_.stop(who);
}

void Engine::command(const std::string& who, Verb verb, std::function<void(Result<CommandDone>)> done) {
  const CommandId id = next_command_++;
  commands_.add(id, std::move(done));
  if (to_sequencer_.post(Command{.id = id, .who = who, .verb = std::move(verb)})) return;
  commands_.answer(id, failure({.code = ErrorCode::Busy,
                                .device = "sequencer",
                                .tried = "take on a command",
                                .seen = fmt::format("{} messages wait already", kMailbox),
                                .limit = {}}));
}

SequencerDesk::Ports Engine::ports() {
  const Duration beat = config_.instrument.stage.heartbeat_timeout / 4;
  return {.to_stage = [this](StageRequest request) { return stage_thread_->post(std::move(request)); },
          .to_detector =
              [this](DetectorRequest request) {
                return camera_thread_ ? camera_thread_->post(std::move(request))
                                      : radiometer_thread_->post(std::move(request));
              },
          .to_monitor =
              [this](MonitorRequest request) { return monitor_thread_ && monitor_thread_->post(std::move(request)); },
          .to_store = [this](StoreRequest request) { return store_thread_->post(std::move(request)); },
          .reply = [this](const CommandReply& reply) { on_reply(reply); },
          .renew = [this] { halt_.renew(); },
          .renew_every = beat / 2};
}

// The loop of ActorThread, on a mailbox that is there before any actor that answers into it.
void Engine::run_sequencer() try {
  std::optional<Instant> wake = step_sequencer();
  while (!to_sequencer_.is_closed()) {
    std::optional<SequencerMessage> message = to_sequencer_.take_until(wake, clock_);
    if (message) give_sequencer(std::move(*message));
    if (!to_sequencer_.is_closed()) wake = step_sequencer();
  }
} catch (const std::exception& bug) {
  on_bug(bug.what());
}

std::optional<Instant> Engine::step_sequencer() {
  const Instant at = clock_.now();
  sequencer_turns_.note(kNoSource, at);
  return desk_->step(at);
}

void Engine::give_sequencer(SequencerMessage message) {
  const Instant at = clock_.now();
  if (config_.tape != nullptr) {
    if (std::optional<drivers::TapeInput> input = tape_input_of(message)) config_.tape->put(std::move(*input));
    sequencer_turns_.note(source_of(message), at);
  }
  desk_->on(message, at);
}

Turns Engine::turns_of(drivers::TapeParty party) const {
  return {.party = party, .tape = config_.tape, .by_hand = config_.by_hand_from.has_value()};
}

Result<void> Engine::take_turn(const drivers::TapeTurn& turn) {
  turn_now_ = turn.now;
  switch (turn.party) {
    case drivers::TapeParty::Sequencer:
      return take_turn_of(*desk_, to_sequencer_, turn);
    case drivers::TapeParty::Stage:
      return stage_thread_->take_turn(turn);
    case drivers::TapeParty::Detector:
      return camera_thread_ ? camera_thread_->take_turn(turn) : radiometer_thread_->take_turn(turn);
    case drivers::TapeParty::Store:
      return store_thread_->take_turn(turn);
    case drivers::TapeParty::Monitor:
      if (monitor_thread_) return monitor_thread_->take_turn(turn);
      break;
    case drivers::TapeParty::Halt:
      break;
  }
  return failure({.code = ErrorCode::ReplayDiffers,
                  .device = std::string(drivers::tape_party_name(turn.party)),
                  .tried = "take its turn",
                  .seen = "this instrument has no such device",
                  .limit = {}});
}

void Engine::tell(SequencerMessage message) {
  if (to_sequencer_.post(std::move(message)) || to_sequencer_.is_closed()) return;
  on_bug("the sequencer's mailbox is full: an answer would be lost");
}

void Engine::on_stage(const StageAnswer& answer) {
  if (answer.state) {
    if (stage_seen_.error()) log_info("stage: answers again");
    halt_.adopt(answer.state->epoch);  // after a restart of the daemon the stage knows the higher one
    stage_seen_.set(*answer.state);
  } else {
    note_stage_error(answer.state.error());
  }
  tell(answer);
}

void Engine::note_stage_error(const Error& error) {
  const std::optional<Error> before = stage_seen_.error();
  if (!before || before->code != error.code) log_warning(describe(error));  // once, not every second
  if (is_of_the_link(error)) stage_seen_.set_error(error);
}

void Engine::on_detector(DetectorActor::Answer answer) {
  const auto note = [this](const auto& result) {
    if (result) {
      detector_seen_.set(true);
      return;
    }
    log_warning(describe(result.error()));
    detector_seen_.set_error(result.error());
  };
  if (auto* frame = std::get_if<FrameAnswer>(&answer)) {
    note(frame->frame);
    tell(std::move(*frame));
  } else {
    auto& prepared = std::get<DetectorAnswer>(answer);
    note(prepared.detector);
    if (prepared.detector) {
      log_info(fmt::format("detector: {} {}, serial {}", prepared.detector->vendor, prepared.detector->model,
                           prepared.detector->serial));
    }
    tell(std::move(prepared));
  }
}

void Engine::on_monitor(MonitorActor::Answer answer) {
  const auto note = [this](const auto& result) {
    if (result) {
      monitor_seen_.set(true);
      return;
    }
    log_warning(describe(result.error()));
    monitor_seen_.set_error(result.error());
  };
  if (auto* reading = std::get_if<MonitorAnswer>(&answer)) {
    note(reading->reading);
    tell(std::move(*reading));
    return;
  }
  auto& ready = std::get<MonitorReady>(answer);
  note(ready.monitor);
  if (ready.monitor) {
    log_info(
        fmt::format("monitor: {} {}, serial {}", ready.monitor->vendor, ready.monitor->model, ready.monitor->serial));
  }
  tell(std::move(ready));
}

void Engine::on_store(StoreActor::Answer answer) {
  if (auto* loaded = std::get_if<UnfinishedAnswer>(&answer)) {
    if (!loaded->scans) log_error(describe(loaded->scans.error()));
    tell(std::move(*loaded));
    return;
  }
  auto& commit = std::get<CommitAnswer>(answer);
  if (!commit.receipt) log_error(describe(commit.receipt.error()));
  if (commit.receipt) {
    for (const EventRecord& event : commit.receipt->events) publish(event);
  }
  if (commit.ticket != SequencerDesk::kOwnTicket) tell(std::move(commit));
}

// Told as news from outside, so that a tape has it: a replay on another disk takes the same way.
std::optional<Instant> Engine::look_at_disk(Instant now) {
  constexpr Duration kLookEvery = std::chrono::seconds(5);
  if (config_.by_hand_from) return std::nullopt;
  if (next_disk_look_ && now < *next_disk_look_) return next_disk_look_;
  next_disk_look_ = now + kLookEvery;
  std::error_code refused;
  const auto folder = std::filesystem::absolute(config_.store_file).parent_path();
  const auto space = std::filesystem::space(folder, refused);
  if (!refused) tell(DiskSeen{.free_bytes = static_cast<std::int64_t>(space.available)});
  return next_disk_look_;
}

void Engine::publish(const EventRecord& event) {
  const bool is_of_an_item = event.kind.starts_with("item-");
  if (!is_of_an_item) log_info(event_sentence(event));
  if (is_of_an_item && log_shows_debug()) log_debug(event_sentence(event));
  on_event_(event);
  if (!asks_for_brdf(event)) return;
  const AskedVersions asked = asked_versions_of(event);
  if (config_.by_hand_from) {
    compute_brdf_of(event.scan, asked);  // the tape says when the store takes it
  } else if (!calibrator_->post([this, scan = event.scan, asked] { compute_brdf_of(scan, asked); })) {
    log_warning(fmt::format("scan {}: its BRDF is computed when it is asked for", event.scan));
  }
}

// A daemon that was killed between a scan's end and its BRDF leaves a job's findings unmade.
void Engine::compute_what_is_missing() {
  constexpr int kNewest = 100;
  const Result<std::unique_ptr<StoreReader>> reader = StoreReader::open(config_.store_file);
  if (!reader) return log_error(describe(reader.error()));
  const Result<std::vector<ScanInfo>> scans = (*reader)->scans(0, kNewest);
  if (!scans) return log_error(describe(scans.error()));
  for (const ScanInfo& scan : *scans) {
    if (scan.state != ScanState::Done && scan.state != ScanState::FinishedEarly) continue;
    const Result<BrdfInfo> brdf = (*reader)->brdf(scan.id);
    if (!brdf && brdf.error().code == ErrorCode::NotFound) compute_brdf_of(scan.id, std::nullopt);
  }
}

// Runs on the calibrator's thread, on its own connection to the store.
void Engine::compute_brdf_of(ScanId scan, const AskedVersions& asked) {
  const Result<std::unique_ptr<StoreReader>> reader = StoreReader::open(config_.store_file);
  Result<NewBrdf> brdf = reader ? compute_brdf(**reader, scan, asked) : failure(reader.error());
  if (!brdf) {
    log_error(fmt::format("scan {}: no BRDF: {}", scan, describe(brdf.error())));
    return;
  }
  log_info(fmt::format("scan {}: BRDF of {} points by {}", scan, brdf->rows.size(), brdf->code_version));
  Result<std::optional<NewFoundCalibration>> found = fit_job(**reader, scan, *brdf);
  StoreTransaction transaction{.at = now(), .writes = {std::move(*brdf)}};
  if (!found) log_error(fmt::format("scan {}: its calibration job found nothing: {}", scan, describe(found.error())));
  if (found && *found) {
    transaction.events.push_back(event_found(**found));
    transaction.writes.emplace_back(std::move(**found));
  }
  transaction.events.push_back({.kind = "brdf-computed", .scan = scan, .who = "goniod", .json = "{}"});
  if (!store_thread_->post(Commit{SequencerDesk::kOwnTicket, std::move(transaction)})) {
    log_warning(fmt::format("scan {}: its BRDF was not stored; it is computed when it is asked for", scan));
  }
}

void Engine::on_halt(const HaltPathReport& report) {
  if (const auto* line = std::get_if<HaltLineReport>(&report)) {
    if (line->is_up) log_info("stage: the line of STOP and heartbeat is up");
    if (!line->is_up && line->error)
      log_warning("stage: the line of STOP and heartbeat is down: " + describe(*line->error));
    return;
  }
  const auto& halt = std::get<HaltReport>(report);
  if (halt.outcome) {
    log_warning(fmt::format("stage: STOP by {}, acknowledged after {:.1f} ms, epoch {}", halt.who,
                            1e3 * in_seconds(halt.took), halt.epoch));
  } else {
    log_error(fmt::format("stage: STOP by {} not delivered yet: {}", halt.who, describe(halt.outcome.error())));
  }
  if (told_epoch_.exchange(halt.epoch) != halt.epoch) tell(StopHappened{.epoch = halt.epoch, .who = halt.who});
  stops_.answer_up_to(halt.epoch, halt.outcome ? Result<drivers::Epoch>(halt.epoch) : failure(halt.outcome.error()));
}

void Engine::on_reply(const CommandReply& reply) {
  commands_.answer(reply.id, reply.result);
}

}  // namespace gonio::daemon
