#include "daemon/engine/actor_thread.h"

#include <gtest/gtest.h>

#include <future>
#include <stdexcept>
#include <vector>

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;

/// Collects numbers; promises to have them when a zero comes.
struct Collector {
  void on(int message, Instant) {
    if (message < 0) throw std::runtime_error("a negative number");
    if (message == 0) done.set_value(seen);
    seen.push_back(message);
  }
  std::optional<Instant> step(Instant now) {
    ++steps;
    if (steps == wakes_wanted) woken.set_value();
    if (steps >= wakes_wanted) return std::nullopt;
    return now + 1ms;
  }

  std::vector<int> seen;
  std::promise<std::vector<int>> done;
  std::promise<void> woken;
  int steps = 0;
  int wakes_wanted = 0;
};

const ActorThread<Collector, int>::OnBug kNoBug = [](const std::string& what) { ADD_FAILURE() << what; };

TEST(ActorThread, HandsMessagesOverInOrder) {
  Collector collector;
  const SystemClock clock;
  ActorThread<Collector, int> thread("collector", collector, clock, 8, kNoBug);

  for (const int message : {3, 1, 2, 0}) ASSERT_TRUE(thread.post(message));

  EXPECT_EQ(collector.done.get_future().get(), (std::vector<int>{3, 1, 2}));
}

TEST(ActorThread, WakesTheActorWhenItAskedToBeWoken) {
  Collector collector;
  collector.wakes_wanted = 3;
  const SystemClock clock;

  ActorThread<Collector, int> thread("collector", collector, clock, 8, kNoBug);

  collector.woken.get_future().wait();
}

TEST(ActorThread, TakesNothingMoreOnceItIsStopped) {
  Collector collector;
  const SystemClock clock;
  ActorThread<Collector, int> thread("a name that is far too long", collector, clock, 8, kNoBug);

  thread.stop();

  EXPECT_FALSE(thread.post(1));
}

TEST(ActorThread, ReportsWhatWasThrownThroughTheActorAndEnds) {
  Collector collector;
  const SystemClock clock;
  std::promise<std::string> bug;
  ActorThread<Collector, int> thread("collector", collector, clock, 8,
                                     [&](const std::string& what) { bug.set_value(what); });

  ASSERT_TRUE(thread.post(-1));

  EXPECT_EQ(bug.get_future().get(), "a negative number");
}

}  // namespace
}  // namespace gonio::daemon
