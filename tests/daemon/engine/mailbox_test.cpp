#include "daemon/engine/mailbox.h"

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <thread>

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;

TEST(Mailbox, GivesMessagesInTheOrderOfPosting) {
  Mailbox<int> box(4);
  const SystemClock clock;
  ASSERT_TRUE(box.post(1));
  ASSERT_TRUE(box.post(2));

  EXPECT_EQ(box.take_until(clock.now(), clock), 1);
  EXPECT_EQ(box.take_until(clock.now(), clock), 2);
}

TEST(Mailbox, HasNothingWhenItsTimeIsUp) {
  Mailbox<int> box(4);
  const SystemClock clock;

  EXPECT_FALSE(box.take_until(clock.now() + 1ms, clock).has_value());
}

TEST(Mailbox, RefusesWhatItCannotHold) {
  Mailbox<int> box(2);
  ASSERT_TRUE(box.post(1));
  ASSERT_TRUE(box.post(2));

  EXPECT_FALSE(box.post(3));
}

TEST(Mailbox, TakesMessagesThatCannotBeCopied) {
  Mailbox<std::unique_ptr<int>> box(2);
  const SystemClock clock;
  ASSERT_TRUE(box.post(std::make_unique<int>(7)));

  const auto taken = box.take_until(std::nullopt, clock);

  ASSERT_TRUE(taken.has_value());
  EXPECT_EQ(**taken, 7);
}

TEST(Mailbox, WakesTheWaitingThreadWhenAMessageComes) {
  Mailbox<int> box(2);
  const SystemClock clock;
  auto taken = std::async(std::launch::async, [&] { return box.take_until(std::nullopt, clock); });

  ASSERT_TRUE(box.post(5));

  EXPECT_EQ(taken.get(), 5);
}

TEST(Mailbox, WakesTheWaitingThreadWhenItIsClosed) {
  Mailbox<int> box(2);
  const SystemClock clock;
  auto taken = std::async(std::launch::async, [&] { return box.take_until(std::nullopt, clock); });

  box.close();

  EXPECT_FALSE(taken.get().has_value());
  EXPECT_FALSE(box.post(1));
  EXPECT_TRUE(box.is_closed());
}

TEST(Mailbox, DropsWhatWasNotTakenWhenItIsClosed) {
  Mailbox<int> box(2);
  const SystemClock clock;
  ASSERT_TRUE(box.post(1));

  box.close();

  EXPECT_FALSE(box.take_until(std::nullopt, clock).has_value());
}

TEST(Mailbox, LosesNothingOfWhatManyThreadsPost) {
  constexpr int kEach = 1000;
  Mailbox<int> box(8);
  const SystemClock clock;
  const auto post_all = [&] {
    for (int i = 1; i <= kEach; ++i) {
      while (!box.post(i)) std::this_thread::yield();
    }
  };
  std::thread one(post_all);
  std::thread other(post_all);

  long sum = 0;
  for (int i = 0; i < 2 * kEach; ++i) sum += box.take_until(std::nullopt, clock).value_or(0);

  one.join();
  other.join();
  EXPECT_EQ(sum, long{kEach} * (kEach + 1));
}

}  // namespace
}  // namespace gonio::daemon
