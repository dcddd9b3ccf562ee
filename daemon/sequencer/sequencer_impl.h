#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/sequencer/active_scan.h"
#include "daemon/sequencer/hold_watch.h"
#include "daemon/sequencer/lamp_warm_up.h"
#include "daemon/sequencer/scan_machine.h"
#include "daemon/sequencer/sequencer.h"
#include "daemon/sequencer/visit_schedule.h"

namespace gonio::daemon {

/// Who, of what nobody asked for.
inline constexpr const char* kDaemon = "goniod";

/// The inside of the sequencer, in six sources: sequencer.cpp (channels and answers), scan_life.cpp (states),
/// scan_jobs.cpp (moves, exposures, results), scan_ahead.cpp (the next move beside the last frame), scan_visits.cpp
/// (visits, and which job is next), scan_commands.cpp (what clients ask).
struct Sequencer::Impl {
  explicit Impl(SequencerConfig configuration)
      : config(std::move(configuration)),
        epoch(config.epoch),
        watch(config.instrument.holds, config.instrument.lamp, config.instrument.monitor.has_value()),
        lamp(config.instrument.lamp.warm_up) {}

  // ---- channels (sequencer.cpp) ----
  enum class StageUse : std::uint8_t {
    Dropped,
    Look,
    Home,
    Reset,
    HomeAgain,
    Darken,
    Move,
    Gate,
    Before,
    After,
    Shut,
    LightLamp,
    LampLook,
    HandLook,
    HandDone,
    HandShutters,
    HandShuttersBack,
    ResumeLook
  };
  enum class DetectorUse : std::uint8_t { Dropped, Prepare, Zero, Frame, HandPrepare, HandFrame };
  enum class MonitorUse : std::uint8_t { Dropped, Prepare, Reading, Lamp };
  struct StageCall {
    Ticket ticket = 0;
    StageUse use = StageUse::Dropped;
  };
  struct DetectorCall {
    Ticket ticket = 0;
    DetectorUse use = DetectorUse::Dropped;
  };
  struct MonitorCall {
    Ticket ticket = 0;
    MonitorUse use = MonitorUse::Dropped;
  };
  struct PendingCommit {
    std::function<void(const CommitReceipt&, Instant)> done;
    std::optional<CommandId> reply_failure_to;
    bool holds_exposures = false;  ///< an item or a visit: the next exposure waits for it
  };

  void ask_stage(StageUse use, StageRequest request);
  void ask_detector(DetectorUse use, DetectorRequest request);
  void ask_monitor(MonitorUse use, MonitorRequest request);
  void commit(StoreTransaction transaction, PendingCommit pending);
  void load_from_store();
  void reply(CommandId id, Result<CommandDone> result) { replies.push_back({id, std::move(result)}); }
  [[nodiscard]] bool channels_are_free() const { return !stage_call && !detector_call && !monitor_call; }
  [[nodiscard]] bool has_uncommitted_item() const;
  /// Open calls are awaited, their answers then thrown away.
  void disown_calls();

  void on_message(const Command& command, Instant now);
  void on_message(const StageAnswer& answer, Instant now);
  void on_message(const FrameAnswer& answer, Instant now);
  void on_message(const DetectorAnswer& answer, Instant now);
  void on_message(const MonitorAnswer& answer, Instant now);
  void on_message(const MonitorReady& answer, Instant now);
  void on_message(const CommitAnswer& answer, Instant now);
  void on_message(const UnfinishedAnswer& answer, Instant now);
  void on_message(const StopHappened& stop, Instant now);
  void on_message(const DiskSeen& disk, Instant now);
  void note_stage(const drivers::StageState& state);
  void store_failed(const Error& error, std::optional<CommandId> command);
  [[nodiscard]] std::optional<Instant> next_wake(Instant now) const;
  [[nodiscard]] SequencerStatus status(Instant now) const;
  [[nodiscard]] Progress progress() const;
  [[nodiscard]] WorkLeft work_left() const;
  void look_at_turns();
  [[nodiscard]] std::string_view doing() const;

  // ---- life (scan_life.cpp) ----
  /// What comes next, after anything happened.
  void advance(Instant now);
  void advance_found(Instant now);
  void advance_preparing(Instant now);
  void advance_measuring(Instant now);
  void begin_finish(Instant now);
  void transition(ScanEvent event, Instant now, const std::string& who, const std::string& reason,
                  std::optional<CommandId> command = std::nullopt, std::vector<StoreWrite> more = {},
                  std::vector<NewEvent> more_events = {});
  void entered(ScanState state, Instant now);
  void count_state(ScanState state, Instant now);
  void add_hold(HoldName name, const std::string& owner, const std::string& reason, Instant now);
  void on_look(const Result<drivers::StageState>& state, Instant now);
  void decide_after_restart(Instant now);
  void verify_stage(const drivers::StageState& state, Instant now);
  void on_prepared_step(const Result<drivers::StageState>& state, ActiveScan::Preparation next, Instant now);
  [[nodiscard]] bool zero_is_due() const;
  void look_again(Duration patience, const std::string& what, Instant now);

  // ---- the lamp's warm-up (scan_warm_up.cpp) ----
  [[nodiscard]] bool lamp_is_warm(Instant now) const;
  void advance_warm_up(Instant now);
  void on_lamp_seen(Instant now);
  [[nodiscard]] std::optional<WarmUpProgress> warm_up_progress(Instant now) const;

  // ---- holds (scan_holds.cpp) ----
  void hold_scan(ActiveScan& held, Hold hold, Instant now, const std::optional<Command>& command);
  void note_again(const ActiveScan& held, const Command& command, Instant now);
  void end_holds(ActiveScan& held, const std::vector<HoldName>& names, const std::string& who,
                 const std::string& reason, Instant now, const std::optional<Command>& command);
  void end_gone_holds(Instant now);
  void decide_resume(const Command& c, ActiveScan& held, std::optional<HoldName> wanted, Instant now);
  void on_resume_look(Instant now);
  void see_stage(const drivers::StageState& state, Instant now);
  void see_lamp(double monitor, Instant now);
  void hold_for_disk(Instant now);

  // ---- whose turn it is (scan_queue.cpp) ----
  [[nodiscard]] std::deque<ActiveScan>::iterator next_in_queue(Instant now);
  [[nodiscard]] const ActiveScan* urgent(int priority, Instant now) const;
  [[nodiscard]] std::optional<Instant> next_start(Instant now) const;
  [[nodiscard]] std::vector<ScanId> queue_in_order() const;
  void activate_next(Instant now);
  void return_from_aside(Instant now);
  [[nodiscard]] bool makes_way(Instant now);
  void set_aside(Instant now);
  void take_up(UnfinishedScan stored);
  [[nodiscard]] ActiveScan* find_scan(ScanId id);
  [[nodiscard]] bool is_active(const ActiveScan& one) const { return scan && &one == &*scan; }
  [[nodiscard]] bool is_aside(const ActiveScan& one) const;
  /// The scan that a command means, when its state takes it; else nullptr, and it is answered.
  [[nodiscard]] ActiveScan* addressed(const Command& c, ScanId id, ScanAsk ask);
  void note_end(ScanId id, ScanState state);

  // ---- jobs (scan_jobs.cpp) ----
  void start_item(const ItemKey& item, Instant now);
  /// Sets where the job's axes go. Errors: those of axis_targets.
  [[nodiscard]] Result<void> aim(Job& job) const;
  void begin_measurement(Job& job) const;
  void ask_to_move(Job& job, Instant now);
  void start_park(Instant now);
  void drive_job(Instant now);
  void begin_exposure(Instant now);
  void take_light(Instant now);
  void on_before(const Result<drivers::StageState>& state, Instant now);
  void on_after(const Result<drivers::StageState>& state, Instant now);
  void on_monitor(const Result<PowerRecord>& reading, Instant now);
  void on_homed_again(const Result<drivers::StageState>& state, Instant now);
  void on_moved(const Result<drivers::StageState>& state, Instant now);
  void on_gate(const Result<drivers::StageState>& state, Instant now);
  void on_frame(const Result<FrameSummary>& frame, Instant now);
  void join_exposure(Instant now);
  [[nodiscard]] bool lamp_is_out(const drivers::GateRecord& gate, Instant now);
  void accept_job(Instant now);
  void accept_item(Job& job, Instant now);
  void job_failed(const Error& error, Instant now);
  void item_failed(const Error& error, Instant now);
  void give_up_item(const ItemKey& item, const Error& error, StoreTransaction transaction, Instant now);
  /// Gives up what is in hand without a decision; exposures made are recorded. Open calls are awaited and dropped.
  void drop_job(Instant now);
  [[nodiscard]] NewAttempt attempt_of(Job& job, AttemptOutcome outcome, Instant now);
  [[nodiscard]] Job new_job(Job::Kind kind, Instant now);
  [[nodiscard]] StepTime model_of(const drivers::MotionTarget& target) const;
  void count_light(Job& job, Instant now);
  void count_as_lost(const Job& job, Instant now);

  // ---- leaving early (scan_ahead.cpp) ----
  void leave_early(Instant now);
  [[nodiscard]] bool may_leave(const Job& job, Instant now) const;
  void take_up_ahead(Instant now);
  void go_back(Instant now);
  void drop_ahead(Instant now);

  // ---- visits, and which job is next (scan_visits.cpp) ----
  void choose_job(Instant now);
  [[nodiscard]] VisitClocks visit_clocks() const;
  /// Of each rung of the next dark.
  [[nodiscard]] int dark_frames() const;
  /// Whether the boundary after the item in hand is a visit's.
  [[nodiscard]] bool visit_is_next_after(const ItemKey& in_hand, Instant now) const;
  /// From where the arms stand, before what is open; `in_hand` does not count as open any more.
  [[nodiscard]] Detour detour_of(NextJob visit, const std::optional<ItemKey>& in_hand, Instant now) const;
  void start_dark(Instant now);
  void accept_dark(Job& job, Instant now);
  void start_visit(NextJob visit, Instant now);
  void accept_visit(Job& job, Instant now);
  void reopen_since(VisitTrack& track, NewVisit& visit, Instant now);
  void keep_in_spite_of_drift(double drift, std::int64_t points, Instant now);
  void visit_failed(const Error& error, Instant now);

  // ---- commands (scan_commands.cpp) ----
  void run(const Command& command, Instant now);
  void run_verb(const Command& c, const SubmitScan& submit, Instant now);
  void run_verb(const Command& c, const PauseScan& pause, Instant now);
  void run_verb(const Command& c, const ResumeScan& resume, Instant now);
  void run_verb(const Command& c, const FinishScan& finish, Instant now);
  void run_verb(const Command& c, const AbortScan& abort, Instant now);
  void run_verb(const Command& c, const SkipItemInHand& skip, Instant now);
  void run_verb(const Command& c, const MoveStage& move, Instant now);
  void run_verb(const Command& c, const HomeStage& home, Instant now);
  void run_verb(const Command& c, const ClearStage& clear, Instant now);
  void run_verb(const Command& c, const ChangeScan& change, Instant now);
  void apply(const ScanChange& record, ActiveScan& changed, Instant now);
  [[nodiscard]] static AuditEntry audit(const Command& c, ScanAsk ask, ScanId scan, const std::string& detail);
  [[nodiscard]] static Error busy(const std::string& tried, const std::string& seen);
  void take_by_hand(const Command& c, Instant now);
  void start_by_hand();
  void on_hand_look(const Result<drivers::StageState>& state);
  void on_hand_done(const Result<drivers::StageState>& state);
  void end_by_hand(Result<CommandDone> result);

  // ---- a reading by hand (hand_reading.cpp) ----
  /// What ReadDetector has in work.
  struct ReadingByHand {
    bool source_was_open = false;
    bool detector_was_open = false;
    bool source_open = false;
    bool detector_open = false;
    std::optional<PowerSettings> power;
    Duration exposure{};
    drivers::DetectorIdentity detector;
    std::optional<Result<CommandDone>> result;  ///< while the shutters go back
    [[nodiscard]] bool moves_shutters() const {
      return source_open != source_was_open || detector_open != detector_was_open;
    }
  };
  void run_verb(const Command& c, const ReadDetector& read, Instant now);
  void run_verb(const Command& c, const UseCalibration& use, Instant now);
  void run_verb(const Command& c, const RecomputeScan& recompute, Instant now);
  [[nodiscard]] Result<void> check_reading(const ReadDetector& read) const;
  void begin_hand_reading(const drivers::StageState& state);
  void on_hand_shutters(const Result<drivers::StageState>& state);
  void on_hand_prepared(const Result<drivers::DetectorIdentity>& detector);
  void on_hand_frame(const Result<FrameSummary>& frame);
  [[nodiscard]] HandReading hand_reading_of(const FrameSummary& frame) const;
  void end_hand_reading(Result<CommandDone> result);
  void on_hand_shutters_back(const Result<drivers::StageState>& state);

  void abort_waiting(const Command& c, const ActiveScan& waits, const std::string& reason, Instant now);
  [[nodiscard]] bool refuse_while_stopped(const Command& c);

  SequencerConfig config;
  drivers::Epoch epoch;
  std::vector<Request> requests;
  std::vector<CommandReply> replies;
  Ticket last_ticket = 0;
  std::optional<StageCall> stage_call;
  std::optional<DetectorCall> detector_call;
  std::optional<MonitorCall> monitor_call;
  std::map<Ticket, PendingCommit> commits;
  std::optional<Ticket> load_call;
  std::optional<drivers::StageState> stage;  ///< as last seen
  bool stage_stopped = false;
  bool shutters_to_close = false;  ///< after an abort
  std::optional<Error> store_error;
  std::string resumed_by;  ///< who resumed after a store error: overrides the restart policy once
  std::optional<CommandId> resume_command;
  std::optional<Command> resume_waits;  ///< for a look at door and lamp
  HoldWatch watch;
  LampWatch lamp;
  bool lamp_was_warm = false;        ///< by the criterion, and not out since
  std::optional<Instant> lamp_seen;  ///< last, in its band
  std::deque<ActiveScan> queue;      ///< behind the active one, by number
  std::vector<ActiveScan> aside;     ///< under way, without the instrument: pre-empted, or found at start-up
  std::deque<std::pair<ScanId, ScanState>> ended;  ///< the last ones
  std::optional<ActiveScan> scan;                  ///< the active one
  bool is_in_transition = false;                   ///< written, not yet committed: nothing is begun meanwhile
  std::deque<Command> waiting;                     ///< commands that came meanwhile
  std::optional<Command> by_hand;                  ///< the stage command in work
  bool by_hand_is_asked = false;                   ///< its first look is out
  bool by_hand_has_reset = false;                  ///< it has cleared a tripped heartbeat already
  std::optional<ReadingByHand> hand_reading;
};

}  // namespace gonio::daemon
