#include "daemon/app/pending_replies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace gonio::daemon {
namespace {

using testing::ElementsAre;

TEST(PendingReplies, AreAnsweredOnceEach) {
  PendingReplies<int> replies;
  std::vector<int> seen;
  replies.add(1, [&](int value) { seen.push_back(value); });
  replies.add(2, [&](int value) { seen.push_back(10 * value); });

  replies.answer(2, 7);
  replies.answer(2, 8);
  replies.answer(1, 9);

  EXPECT_THAT(seen, ElementsAre(70, 9));
}

TEST(PendingReplies, OneStopAnswersAllThatWereAskedBefore) {
  PendingReplies<int> replies;
  int answered = 0;
  for (const std::uint64_t epoch : {4U, 4U, 5U, 6U}) replies.add(epoch, [&](int) { ++answered; });

  replies.answer_up_to(5, 0);

  EXPECT_EQ(answered, 3);
}

TEST(PendingReplies, ACallbackMayAskAgain) {
  PendingReplies<int> replies;
  int answered = 0;
  replies.add(1, [&](int) { replies.add(2, [&](int) { ++answered; }); });

  replies.answer(1, 0);
  replies.answer(2, 0);

  EXPECT_EQ(answered, 1);
}

TEST(PendingReplies, ManyThreadsLoseNone) {
  PendingReplies<int> replies;
  std::atomic<int> answered{0};
  std::vector<std::thread> threads;
  for (std::uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint64_t i = 0; i < 500; ++i) {
        const std::uint64_t id = 500 * t + i;
        replies.add(id, [&](int) { ++answered; });
        replies.answer(id, 0);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();

  EXPECT_EQ(answered, 2000);
}

}  // namespace
}  // namespace gonio::daemon
