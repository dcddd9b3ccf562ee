#include "daemon/app/simulate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

using testing::ElementsAre;

TEST(Simulate, PassesTheDaemonsOptionsThroughAndTheSimulatorsToIt) {
  const std::vector<std::string> command = simulation_command(
      {"--simulate", "glint.toml", "--seed", "7", "--store", "s.sqlite", "--listen", "127.0.0.1:0"}, "/opt/bin/goniod");

  EXPECT_THAT(command,
              ElementsAre("/opt/bin/goniosim", "glint.toml", "--seed", "7", "--", "/opt/bin/goniod", "--instrument",
                          "{state}/instrument.toml", "--store", "s.sqlite", "--listen", "127.0.0.1:0"));
}

TEST(Simulate, WithoutASceneTakesTheUsualOne) {
  EXPECT_THAT(simulation_command({"--simulate", "--log-level", "debug"}, "/b/goniod"),
              ElementsAre("/b/goniosim", "wheat", "--", "/b/goniod", "--instrument", "{state}/instrument.toml",
                          "--log-level", "debug"));
}

TEST(Simulate, TheInstrumentIsTheSimulatorsOwn) {
  EXPECT_THAT(simulation_command({"--instrument", "mine.toml", "--simulate", "dark"}, "/b/goniod"),
              ElementsAre("/b/goniosim", "dark", "--", "/b/goniod", "--instrument", "{state}/instrument.toml"));
}

TEST(Simulate, ASimulatorThatIsNotThereIsNamed) {
  const Error error = become({"/nowhere/goniosim", "wheat"});

  EXPECT_EQ(error.code, ErrorCode::FileUnreadable);
  EXPECT_EQ(error.where->file, "/nowhere/goniosim");
}

}  // namespace
}  // namespace gonio::daemon
