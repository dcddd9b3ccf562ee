#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/sequencer/messages.h"
#include "drivers/motion/motion_progress.h"
#include "drivers/motion/route.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// Drives the stage. A move is planned from where the stage really stands (`plan_route`): it may take several legs,
/// each begun when the one before has come to rest, all of one epoch. A STOP between two legs ends the move.
///
/// One request at a time, in the order of asking, each answered once; a look is answered at once,
/// also while a motion is under way. Blocks for a few link transactions at most, never for a motion. Threads: one.
class StageActor {
 public:
  using Post = std::function<void(StageAnswer)>;
  /// Requests that may wait behind the one in hand; one more is answered with Busy.
  static constexpr std::size_t kMostWaiting = 16;

  /// `stage` and `config` must outlive it. `post` is called from `on` and `step`.
  StageActor(drivers::Stage& stage, const drivers::StageConfig& config, Post post);

  void on(const StageRequest& request, Instant now);
  /// Says when to come again; nothing while there is nothing to wait for.
  [[nodiscard]] std::optional<Instant> step(Instant now);

 private:
  /// How old the look that ended an exposure may be for a move to begin by it.
  static constexpr Duration kFresh = std::chrono::milliseconds(20);

  /// One condition that the stage must come to meet.
  using Watch = std::function<Result<drivers::MotionProgress>(const drivers::StageState&, Instant)>;
  /// A request that waits for the stage: done when all its conditions hold in one look.
  struct Job {
    Ticket ticket = 0;
    std::vector<Watch> watches = {};  ///< of a move, the motion's is the last
    Instant next_look{};
    std::deque<drivers::MotionTarget> legs = {};  ///< of a move, those to come
    drivers::Epoch epoch = 0;
    std::uint16_t stop_count = 0;                  ///< of the stage when the move began
    drivers::MotionTarget ends = {};               ///< the axes of a move and where they will be
    std::optional<drivers::StageState> seen = {};  ///< already, beside the command: the first look
    bool is_of_a_gate = false;
  };

  [[nodiscard]] Result<drivers::StageState> look();
  [[nodiscard]] Result<drivers::StageState> look_before_a_move(Instant now);
  [[nodiscard]] Result<drivers::StageState> look_for_the_job();
  void note(const drivers::StageState& seen);
  void note_rest(const drivers::StageState& seen);
  [[nodiscard]] Result<void> check_rest(const MoveTo& request, const drivers::StageState& seen) const;
  void begin(const StageRequest& request, Instant now);
  [[nodiscard]] Result<Job> start(const MoveTo& request, Instant now);
  [[nodiscard]] Result<Job> start(const Home& request);
  [[nodiscard]] Result<Job> start(const ResetStage& request);
  [[nodiscard]] Result<void> add_shutters(Job& job, const MoveTo& request, const drivers::StageState& before);
  [[nodiscard]] Result<void> check_arms_are_known(const drivers::StageState& before,
                                                  const drivers::MotionTarget& target) const;
  /// Begins the next leg of a move from a look at rest. Errors: Stopped, those of Stage::start_move.
  [[nodiscard]] Result<void> start_leg(Job& job, const drivers::StageState& before);
  void advance();
  void finish(const Result<drivers::StageState>& state);

  drivers::Stage& stage_;
  const drivers::StageConfig& config_;
  Post post_;
  std::deque<StageRequest> waiting_;
  std::optional<Job> job_;
  std::optional<std::uint32_t> boot_counter_;      ///< as last seen
  drivers::SlackTakenUp slack_taken_up_{};         ///< what moves that ended well have left
  std::optional<drivers::StageState> left_;        ///< the first state at rest after the last motion
  std::optional<drivers::StageState> after_gate_;  ///< the last look, if it ended an exposure
};

}  // namespace gonio::daemon
