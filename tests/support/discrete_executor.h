#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"

namespace gonio::test {

/// Runs actors in one thread on a clock that it moves itself: all mail first, then every actor, then the clock jumps to
/// the earliest wake. The same run whatever the machine does, and as fast as the code in it. Rules: an actor's step
/// asks for the time at which it wants to be stepped again, and is stepped at every stop besides; answers are posted,
/// never handed over inside a step. Mail is delivered in the order of posting.
class DiscreteExecutor {
 public:
  using Step = std::function<std::optional<Instant>(Instant now)>;
  using Delivery = std::function<void(Instant now)>;
  enum class Outcome : std::uint8_t {
    Reached,   ///< the condition holds
    Idle,      ///< no mail, and nobody wants to be woken
    TimeUp,    ///< the limit on the clock was reached
    Spinning,  ///< an actor keeps the clock from moving
  };

  explicit DiscreteExecutor(ManualClock& clock) : clock_(clock) {}

  void add(std::string name, Step step);
  void post(Delivery delivery) { mail_.push_back(std::move(delivery)); }

  /// Runs until `reached` holds, asked whenever all mail of an instant is delivered and all actors are stepped.
  [[nodiscard]] Outcome run_until(const std::function<bool()>& reached, Duration limit);
  /// Runs for `time`, then the clock stands exactly there.
  void run_for(Duration time);

  /// Who wanted what last: for the message of a failed test.
  [[nodiscard]] std::string describe() const;

 private:
  struct Party {
    std::string name;
    Step step;
    std::optional<Instant> wake;
  };

  void deliver_all();
  void step_all();
  [[nodiscard]] std::optional<Instant> earliest_wake() const;

  ManualClock& clock_;
  std::vector<Party> parties_;
  std::deque<Delivery> mail_;
};

}  // namespace gonio::test
