// What it costs to prove a move clear of the keep-out, and to find its legs, in microseconds of processor time a move:
// 1000 random moves between places whose ends are clear, on arms and on a turning sample, each axis by itself and
// coordinated.
#include <fmt/core.h>

#include <algorithm>
#include <ctime>
#include <random>
#include <vector>

#include "drivers/keep_out/path_conflict.h"
#include "drivers/kinematics/kinematics.h"
#include "drivers/motion/route.h"
#include "tests/drivers/keep_out/arms_on_a_bench.h"

namespace gonio::bench {
namespace {

using drivers::KinematicsKind;
using drivers::MotionTarget;
using drivers::StageConfig;
using Places = stage::PerAxis<double>;

constexpr unsigned kSeed = 1;
constexpr std::size_t kMoves = 1000;
constexpr int kRounds = 21;

struct Move {
  Places from{};
  MotionTarget to{};
};

StageConfig stage_of(KinematicsKind kind, bool coordinated) {
  StageConfig config = drivers::test::arms_on_a_bench();
  config.coordinated = coordinated;
  config.kinematics.kind = kind;
  if (kind == KinematicsKind::TurningSample) config.axes[1].low = -160.0;
  return config;
}

std::vector<Move> random_moves(const StageConfig& config) {
  std::mt19937_64 chance(kSeed);
  const auto clear_place = [&] {
    Places at{};
    do {
      for (std::size_t a = 0; a < 4; ++a) {
        at[a] = std::uniform_real_distribution<double>(config.axes[a].low, config.axes[a].high)(chance);
      }
    } while (separation(config.kinematics, at) < config.keep_out->least_separation() + drivers::kPathResolution);
    return at;
  };
  std::vector<Move> moves(kMoves);
  for (Move& move : moves) {
    move.from = clear_place();
    const Places to = clear_place();
    for (std::size_t a = 0; a < 4; ++a) move.to[a] = to[a];
  }
  return moves;
}

double processor_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Of each move the median over the rounds, sorted.
template <class Work>
std::vector<double> times_of(const std::vector<Move>& moves, Work work) {
  std::vector<double> medians;
  for (const Move& move : moves) {
    std::vector<double> times;
    for (int round = 0; round < kRounds; ++round) {
      const double begin = processor_us();
      work(move);
      times.push_back(processor_us() - begin);
    }
    std::nth_element(times.begin(), times.begin() + kRounds / 2, times.end());
    medians.push_back(times[kRounds / 2]);
  }
  std::sort(medians.begin(), medians.end());
  return medians;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value / static_cast<double>(values.size());
  return sum;
}

void run(const char* name, const StageConfig& config) {
  const std::vector<Move> moves = random_moves(config);
  int blocked = 0, round = 0, refused = 0;
  for (const Move& move : moves) {
    blocked += path_conflict(config, move.from, move.to) ? 1 : 0;
    const auto legs = plan_route(config, move.from, move.to, {});
    refused += legs ? 0 : 1;
    round += legs && legs->size() > 1 ? 1 : 0;
  }
  const auto proof = times_of(moves, [&](const Move& m) { return path_conflict(config, m.from, m.to).has_value(); });
  const auto route = times_of(moves, [&](const Move& m) { return plan_route(config, m.from, m.to, {}).has_value(); });
  fmt::print("| {} | {} | {} | {} | {:.2f} | {:.2f} | {:.1f} | {:.2f} | {:.1f} |\n", name, blocked, round, refused,
             mean(proof), proof[kMoves / 2], proof.back(), mean(route), route.back());
}

}  // namespace
}  // namespace gonio::bench

int main() {
  using gonio::bench::run;
  using gonio::bench::stage_of;
  using gonio::drivers::KinematicsKind;
  fmt::print("seed {}; {} moves, each the median of {} times; microseconds\n\n", gonio::bench::kSeed,
             gonio::bench::kMoves, gonio::bench::kRounds);
  fmt::print(
      "| stage | straight way blocked | way round | refused | proof, mean | median | worst | route, mean | worst |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  run("arms, each axis by itself", stage_of(KinematicsKind::Arms, false));
  run("arms, coordinated", stage_of(KinematicsKind::Arms, true));
  run("turning sample, each axis by itself", stage_of(KinematicsKind::TurningSample, false));
  run("turning sample, coordinated", stage_of(KinematicsKind::TurningSample, true));
  return 0;
}
