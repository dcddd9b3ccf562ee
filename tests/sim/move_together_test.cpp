// The stage's coordinated move (command 3), seen through its registers as a driver sees it.
#include <string>
#include <vector>

#include "daemon/config/instrument.h"
#include "sim/scene/drive_stage.h"
#include "sim/scene/papers.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

constexpr double kCount = 1e-4;  // deg, of each of the four turning axes

struct AxisTarget {
  Axis axis;
  double position;
};

class MoveTogether : public testing::Test {
 protected:
  MoveTogether() { bench.home(); }

  void command(std::uint16_t what, const std::vector<AxisTarget>& targets) {
    const stage::Block block = bench.map().motion_block();
    std::vector<std::uint16_t> words(block.count, 0);
    const auto put = [&](const stage::Register& reg, std::int64_t v) { stage::encode(words, block.first, reg, v); };
    std::int64_t mask = 0;
    for (const AxisTarget& target : targets) {
      mask |= std::int64_t{1} << stage::index_of(target.axis);
      put(bench.map().at(target.axis, AxisField::Target),
          std::llround(target.position / bench.map().axis_scale[stage::index_of(target.axis)]));
    }
    put(bench.map().at(Field::MotionToken), ++bench.token);
    put(bench.map().at(Field::MotionMask), mask);
    put(bench.map().at(Field::MotionCommand), what);
    bench.last_write = bench.face.write(block.first, words, bench.now);
  }

  bool is_moving(Axis axis) {
    return (bench.value(bench.map().at(axis, AxisField::Status)) & stage::bit(stage::AxisBit::Moving)) != 0;
  }

  Bench bench;
};

// Of all, 60 deg of theta_i (20 deg/s, 40 deg/s^2) take the longest, by speed and by acceleration: 60 / 20 + 20 / 40 =
// 3.5 s.
TEST_F(MoveTogether, KeepsAllAxesOnTheLineBetweenTheEnds) {
  command(stage::kCommandMoveTogether,
          {{Axis::ThetaI, 60.0}, {Axis::ThetaR, 15.0}, {Axis::PhiR, -100.0}, {Axis::Carriage, 120.0}});
  ASSERT_EQ(bench.refusal(), stage::Refusal::None);

  for (int k = 0; k < 34; ++k) {
    bench.wait(0.1);
    const double part = bench.position(Axis::ThetaI) / 60.0;
    EXPECT_NEAR(bench.position(Axis::ThetaR), 15.0 * part, 2.0 * kCount) << "after " << k + 1 << " tenths";
    EXPECT_NEAR(bench.position(Axis::PhiR), -100.0 * part, 3.0 * kCount);
    EXPECT_NEAR(bench.position(Axis::Carriage), 120.0 * part, 2e-3);
    for (const Axis axis : {Axis::ThetaI, Axis::ThetaR, Axis::PhiR, Axis::Carriage}) EXPECT_TRUE(is_moving(axis));
  }
  bench.wait(0.099);
  for (const Axis axis : {Axis::ThetaI, Axis::ThetaR, Axis::PhiR, Axis::Carriage}) EXPECT_TRUE(is_moving(axis));
  bench.wait(0.002);
  for (const Axis axis : {Axis::ThetaI, Axis::ThetaR, Axis::PhiR, Axis::Carriage}) EXPECT_FALSE(is_moving(axis));
  EXPECT_NEAR(bench.position(Axis::PhiR), -100.0, kCount);
}

TEST_F(MoveTogether, AnAxisAloneGoesAsFastAsItCan) {
  command(stage::kCommandMoveTogether, {{Axis::ThetaI, 60.0}, {Axis::ThetaR, 0.0}});

  bench.wait(3.499);
  EXPECT_TRUE(is_moving(Axis::ThetaI));
  EXPECT_FALSE(is_moving(Axis::ThetaR));
  bench.wait(0.002);
  EXPECT_FALSE(is_moving(Axis::ThetaI));
}

// Parts of the way: 3 slots of the wheel limit the speed to 2 / 3 a second, 100 mm of the carriage the acceleration to
// 200 / 100 a second squared: 3 / 2 + (2 / 3) / 2 s.
TEST_F(MoveTogether, TakesTheSlowestSpeedAndTheSlowestAcceleration) {
  command(stage::kCommandMoveTogether, {{Axis::Carriage, 100.0}, {Axis::FilterWheel, 4.0}});

  bench.wait(1.833);
  EXPECT_TRUE(is_moving(Axis::Carriage) && is_moving(Axis::FilterWheel));
  bench.wait(0.002);
  EXPECT_FALSE(is_moving(Axis::Carriage) || is_moving(Axis::FilterWheel));
}

TEST_F(MoveTogether, IsRefusedBeyondALimitAsAnyMove) {
  command(stage::kCommandMoveTogether, {{Axis::ThetaI, 20.0}, {Axis::ThetaR, 86.0}});

  EXPECT_EQ(bench.refusal(), stage::Refusal::BeyondLimit);
  EXPECT_FALSE(is_moving(Axis::ThetaI));
}

// Each drive has its own start: there is no line to promise.
TEST(CoordinatedConfiguration, IsRefusedForAStageOfDrives) {
  Scene scene = quiet_scene();
  scene.stage.drives = drive_stage_of(scene.stage);
  std::string text = instrument_toml(scene, {});
  const std::string heading = "[stage]\n";
  ASSERT_NE(text.find(heading), std::string::npos);
  ASSERT_TRUE(daemon::parse_instrument(text, "instrument.toml"));
  text.insert(text.find(heading) + heading.size(), "coordinated = true\n");

  const auto instrument = daemon::parse_instrument(text, "instrument.toml");

  ASSERT_FALSE(instrument);
  EXPECT_EQ(instrument.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(explain(instrument.error()).find("coordinated"), std::string::npos) << explain(instrument.error());
}

}  // namespace
}  // namespace gonio::sim::test
