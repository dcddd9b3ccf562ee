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
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// Drives the stage: one request at a time, in the order of asking, each answered once; a look is answered at once,
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
  /// One condition that the stage must come to meet.
  using Watch = std::function<Result<drivers::MotionProgress>(const drivers::StageState&, Instant)>;
  /// A request that waits for the stage: done when all its conditions hold in one look.
  struct Job {
    Ticket ticket = 0;
    std::vector<Watch> watches;
    Instant next_look{};
  };

  [[nodiscard]] Result<drivers::StageState> look();
  void begin(const StageRequest& request, Instant now);
  [[nodiscard]] Result<Job> start(const MoveTo& request);
  [[nodiscard]] Result<Job> start(const Home& request);
  [[nodiscard]] Result<Job> start(const ResetStage& request);
  [[nodiscard]] Result<void> add_shutters(Job& job, const MoveTo& request, const drivers::StageState& before);
  void advance();

  drivers::Stage& stage_;
  const drivers::StageConfig& config_;
  Post post_;
  std::deque<StageRequest> waiting_;
  std::optional<Job> job_;
  std::optional<std::uint32_t> boot_counter_;  ///< as last seen
};

}  // namespace gonio::daemon
