#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/sequencer/sequencer.h"
#include "daemon/store/store_actor.h"
#include "daemon/store/store_reader.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::daemon::test {

/// The instrument as seen through its answers: stage and camera scripted by hand, not by drivers. It outlives the
/// daemon.
struct ScriptedInstrument {
  drivers::StageState stage;
  Instant moving_until{};
  Instant gate_open_until{};
  int exposures = 0;                  ///< since power-up
  std::map<ItemKey, int> exposed_at;  ///< lit frames by what was in view (point by theta_r, see ScanRig)
  double dark_dn = 100.0;
  std::function<double(double theta_r_deg, bool is_reference)> rate_dn_per_s = [](double, bool) { return 300'000.0; };
  std::function<std::optional<Error>(const MoveTo&)> move_error = [](const MoveTo&) { return std::nullopt; };
  std::function<std::optional<Error>()> frame_error = [] { return std::nullopt; };
  Duration frame_error_after = std::chrono::milliseconds(100);  ///< the gate's error comes after 500 ms
  std::function<std::optional<Error>()> camera_open_error = [] { return std::nullopt; };
  Duration frame_takes =
      std::chrono::milliseconds(2);  ///< from the end of the light to the frame; the gate says it 1 ms after
  Instant frame_due{};               ///< of the last exposure
  int moves_beside_a_frame = 0;      ///< begun after the light and before the frame
  double monitor = 1.0;
  std::function<double(Instant)> gain = [](Instant) { return 1.0; };  ///< of lamp or detector, unseen by the monitor
  // Of a radiometer in the camera's place, and of one in the lamp's light.
  double zero_w = 3e-7;  ///< in the dark
  std::function<double(double theta_r_deg, bool is_reference)> power_w = [](double, bool) { return 4e-5; };
  std::function<std::optional<Error>()> monitor_error = [] { return std::nullopt; };
  double monitor_w = 1e-3;
  int zeros = 0;  ///< commanded
  bool zeroed_in_the_dark = true;
  int monitor_readings = 0;
  std::function<void()> during_reading = [] {};  ///< while the light is taken
};

/// A rig's clock as its store sees it: somebody may set the wall clock, forwards or back.
class SettableClock final : public Clock {
 public:
  explicit SettableClock(const Clock& clock) : clock_(clock) {}
  [[nodiscard]] Instant now() const override { return clock_.now(); }
  [[nodiscard]] UtcTime utc_now() const override { return clock_.utc_now() + ahead_; }
  void set_ahead_by(Duration more) { ahead_ += more; }

 private:
  const Clock& clock_;
  Duration ahead_{};
};

/// Sequencer, real store and scripted instrument on a manual clock. Each request executed and each answer delivered is
/// one step, so that a test can kill the daemon between any two.
class ScanRig {
 public:
  /// Keeps its store in a scratch folder in memory, or at `store_path`, on a disk that is really written.
  explicit ScanRig(Instrument instrument = bench_instrument(), std::optional<std::string> store_path = std::nullopt);

  ScriptedInstrument world;
  std::vector<CommandReply> replies;
  std::vector<EventRecord> events;                   ///< as published: in order
  std::function<void(const EventRecord&)> on_event;  ///< if set, events go there and are not kept
  bool refuse_commits = false;                       ///< DiskFull for all that follow
  std::string asked;  ///< what was asked for last, of whomever: "move", "look", "frame", "commit"

  /// One step; false when nothing is left to do.
  bool step();
  /// Steps until `reached` or nothing is left; false in the latter case, and after 100 000 steps.
  bool run_until(const std::function<bool()>& reached);
  bool run_to_rest() {
    return run_until([] { return false; });
  }
  /// The daemon is gone at once: what was under way between its parts is lost. The instrument goes on.
  void kill();
  void start();
  /// The same where the store may refuse; nothing is started then.
  [[nodiscard]] Result<void> try_start();
  [[nodiscard]] bool is_started() const { return sequencer_.has_value(); }

  CommandId command(Verb verb, const std::string& who = "uid:1000");
  [[nodiscard]] const CommandReply* reply_to(CommandId id) const;
  ScanId submit(const api::Plan& plan);
  /// STOP as the halt path does it: the stage first, then the word.
  void stop();
  /// Others look at the stage once a second, for so long.
  void watch_for(Duration time);
  void tell_disk(std::int64_t free_bytes);

  [[nodiscard]] SequencerStatus status() const { return sequencer_->status(clock_.now()); }
  [[nodiscard]] ScanState state_of(ScanId id);
  [[nodiscard]] ScanInfo info(ScanId id);
  [[nodiscard]] std::int64_t count(const std::string& query);
  [[nodiscard]] const std::string& store_path() const { return path_; }
  [[nodiscard]] ManualClock& clock() { return clock_; }
  [[nodiscard]] SettableClock& wall_clock() { return wall_clock_; }

 private:
  using Action = std::function<void()>;
  void after(Duration delay, Action action);
  void tell(Duration delay, SequencerMessage message);
  void collect();
  void execute(const Request& request);
  void execute_stage(const StageRequest& request);
  void execute_detector(const DetectorRequest& request);
  void execute_monitor(const MonitorRequest& request);
  void execute_store(const StoreRequest& request);
  void move(const MoveTo& move);
  void take_frame(const TakeFrame& take);
  void take_power(const TakeFrame& take);
  void zero(const ZeroDetector& request);
  [[nodiscard]] drivers::StageState look();
  [[nodiscard]] FrameSummary frame_of(const drivers::ExposureSettings& settings);

  Instrument instrument_;
  ScratchFolder folder_;
  std::string path_;
  ManualClock clock_;
  SettableClock wall_clock_{clock_};
  std::unique_ptr<StoreWriter> writer_;
  std::optional<StoreActor> store_;
  std::optional<Sequencer> sequencer_;
  std::multimap<Instant, Action> agenda_;
  std::optional<WatchGate> watched_;
  std::optional<Ticket> open_move_;
  CommandId last_command_ = 0;
};

/// A flat field on the bench instrument, two points, 3 frames of each exposure in a dark.
[[nodiscard]] api::Plan map_plan();
/// Each accepted reading of the standard and each dark has the sums of just its frames that count, and nothing else has
/// any; their means are those of the scripted camera.
void expect_sums_of_whole_readings(ScanRig& rig, ScanId id);

}  // namespace gonio::daemon::test
