#include "daemon/desks/event_sentence.h"

#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

TEST(EventSentence, TellsWhoAndWhyAndLeavesListsOut) {
  const EventRecord event{.number = 888,
                          .kind = "hold-added",
                          .scan = 3,
                          .who = "local",
                          .json = R"({"hold":"operator","reason":"lunch","gate_counts":[1,2],"time":{"move_s":1}})"};

  EXPECT_EQ(event_sentence(event), "scan 3: hold added by local (hold operator, reason lunch)");
}

TEST(EventSentence, OfNoScanNamesNone) {
  EXPECT_EQ(event_sentence({.kind = "run-started", .who = "goniod", .json = "{}"}), "run started by goniod");
}

}  // namespace
}  // namespace gonio::daemon
