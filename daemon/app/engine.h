#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/app/latest.h"
#include "daemon/app/pending_replies.h"
#include "daemon/app/sequencer_desk.h"
#include "daemon/config/instrument.h"
#include "daemon/engine/actor_thread.h"
#include "daemon/engine/detector_actor.h"
#include "daemon/engine/halt_path.h"
#include "daemon/engine/monitor_actor.h"
#include "daemon/engine/radiometer_actor.h"
#include "daemon/engine/stage_actor.h"
#include "daemon/engine/turns.h"
#include "daemon/http/worker.h"
#include "daemon/results/version_desk.h"
#include "daemon/store/store_actor.h"

namespace gonio::daemon {

/// The devices that the engine drives; they outlive it.
struct EngineDevices {
  drivers::Stage& stage;
  drivers::HaltLine& halt_line;
  drivers::Detector* camera = nullptr;        ///< null: a radiometer is the detector
  drivers::Radiometer* radiometer = nullptr;  ///< likewise
  drivers::Radiometer* monitor = nullptr;     ///< null: the stage's own
};

/// All actors with their threads, wired: stage, detector (camera or radiometer), monitor, store, sequencer, halt path,
/// and a worker that computes BRDF when a scan ends. Threads: any.
class Engine {
 public:
  struct Config {
    Instrument instrument;
    std::string store_file;  ///< for readers beside `writer`
    /// Every turn of every actor, and what clients ask, goes here when it is set; it must outlive the engine.
    drivers::TapeSink* tape = nullptr;
    /// No actor has a thread: from this instant on `take_turn` makes them act as a tape has it, on the caller's thread.
    std::optional<Instant> by_hand_from = std::nullopt;
  };
  /// A committed event; called on the store's thread, in order.
  using OnEvent = std::function<void(const EventRecord&)>;

  /// Everything runs from here on: scans that were under way are taken up again. `writer`, `clock` and the devices
  /// outlive it.
  Engine(Config config, EngineDevices devices, StoreWriter& writer, const Clock& clock, OnEvent on_event);
  /// Ends all threads. What was committed stays; the stage stops by its own watch.
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// STOP: at once to the halt thread. `done` comes when the stage has acknowledged, or why it has not yet.
  void stop(const std::string& who, std::function<void(Result<drivers::Epoch>)> done);
  /// To the sequencer. `done` comes once.
  void command(const std::string& who, Verb verb, std::function<void(Result<CommandDone>)> done);

  /// Only with Config::by_hand_from: one recorded turn again. Errors: ReplayDiffers.
  [[nodiscard]] Result<void> take_turn(const drivers::TapeTurn& turn);
  /// Only with Config::by_hand_from: what reached the sequencer from a client or the halt path; it waits for its turn.
  void take_in(SequencerMessage message) { tell(std::move(message)); }

  [[nodiscard]] SequencerStatus status() const { return desk_->status(); }
  [[nodiscard]] const Latest<drivers::StageState>& stage() const { return stage_seen_; }
  /// The last error of the detector, else of a radiometer that is the monitor; a success clears it.
  [[nodiscard]] std::optional<Error> detector_error() const {
    const std::optional<Error> error = detector_seen_.error();
    return error ? error : monitor_seen_.error();
  }

 private:
  /// The store's actor, with what follows a commit.
  class StoreDesk {
   public:
    explicit StoreDesk(Engine& engine) : engine_(engine), actor_(engine.writer_) {}
    void on(const StoreRequest& request, Instant now) { engine_.on_store(actor_.on(request, now)); }
    std::optional<Instant> step(Instant now) { return engine_.look_at_disk(now); }

   private:
    Engine& engine_;
    StoreActor actor_;
  };

  void on_stage(const StageAnswer& answer);
  void note_stage_error(const Error& error);
  void on_detector(DetectorActor::Answer answer);
  void on_monitor(MonitorActor::Answer answer);
  void make_detector(const EngineDevices& devices);
  void on_store(StoreActor::Answer answer);
  std::optional<Instant> look_at_disk(Instant now);
  void on_halt(const HaltPathReport& report);
  void on_reply(const CommandReply& reply);
  void publish(const EventRecord& event);
  void compute_what_is_missing();
  void compute_brdf_of(ScanId scan, const AskedVersions& asked);
  void tell(SequencerMessage message);
  void run_sequencer();
  std::optional<Instant> step_sequencer();
  void give_sequencer(SequencerMessage message);
  [[nodiscard]] Instant now() const { return config_.by_hand_from ? turn_now_ : clock_.now(); }
  [[nodiscard]] Turns turns_of(drivers::TapeParty party) const;
  [[nodiscard]] SequencerDesk::Ports ports();

  const Config config_;
  StoreWriter& writer_;
  const Clock& clock_;
  const OnEvent on_event_;
  std::atomic<CommandId> next_command_{1};
  std::atomic<drivers::Epoch> told_epoch_{0};
  PendingReplies<Result<CommandDone>> commands_;
  PendingReplies<Result<drivers::Epoch>> stops_;
  Latest<drivers::StageState> stage_seen_;
  Latest<bool> detector_seen_;
  Latest<bool> monitor_seen_;
  Instant turn_now_{};                     ///< of the turn in hand, by hand
  std::optional<Instant> next_disk_look_;  ///< the store's thread only
  const Turns sequencer_turns_;
  TurnQueue<SequencerMessage> to_sequencer_;

  // In the order of starting; each is used by those below it only, or through the mailbox above.
  HaltPath halt_;
  StageActor stage_actor_;
  std::unique_ptr<DetectorActor> camera_actor_;  ///< or the next one
  std::unique_ptr<RadiometerActor> radiometer_actor_;
  std::unique_ptr<MonitorActor> monitor_actor_;
  StoreDesk store_desk_;
  std::unique_ptr<Worker> calibrator_;
  std::unique_ptr<ActorThread<StoreDesk, StoreRequest>> store_thread_;
  std::unique_ptr<ActorThread<StageActor, StageRequest>> stage_thread_;
  std::unique_ptr<ActorThread<DetectorActor, DetectorRequest>> camera_thread_;
  std::unique_ptr<ActorThread<RadiometerActor, DetectorRequest>> radiometer_thread_;
  std::unique_ptr<ActorThread<MonitorActor, MonitorRequest>> monitor_thread_;
  std::unique_ptr<SequencerDesk> desk_;
  std::thread sequencer_thread_;
};

}  // namespace gonio::daemon
