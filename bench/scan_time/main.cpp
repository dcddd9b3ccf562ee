// A step scan on goniosim at the speed of life (time_scale 1), whole programs over Modbus TCP and GigE Vision: what it
// takes beside what its motions, settling and light must take; idle time by cause; what the dry run and the running
// estimate had said. A short scan runs first, as on every stage that has been used: it teaches the dry run.
// Usage: bench_scan_time [POINTS]   (a multiple of 80; 2000 take about 20 minutes)
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "bench/scan_time/stored_scan.h"
#include "daemon/config/instrument.h"
#include "tests/scenario/bench.h"

namespace {

using namespace gonio;
using SteadyClock = std::chrono::steady_clock;

constexpr int kThetaSteps = 80;
constexpr double kRatioLimit = 1.05;
constexpr double kEtaLimit = 0.03;
constexpr double kDryRunLimit = 0.05;

double seconds_between(SteadyClock::time_point from, SteadyClock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

std::string step_plan(int points) {
  test::PlanOptions options;
  options.theta_i_deg = "[30]";
  options.theta_r_deg = fmt::format("{{from = 40, to = {}, step = 0.25}}", 40.0 + 0.25 * (kThetaSteps - 1));
  options.phi_r_deg = fmt::format("{{from = 60, to = {}, step = 4}}", 60 + 4 * (points / kThetaSteps - 1));
  options.target_snr = 500.0;
  options.block_s = 120;
  options.dark_s = 300;
  // About what the card reflects: whoever plans a scan has looked at the sample.
  std::string text = test::plan_text(options);
  const std::size_t scan = text.find("[geometry]");
  return text.insert(scan, "expected_reflectance = 0.5\n");
}

// What the scan said of its end while it ran.
struct Estimate {
  SteadyClock::time_point at;
  double done = 0.0;  ///< share of the items
  double remaining_s = 0.0;
  double u_s = 0.0;
};

struct Watched {
  std::vector<Estimate> estimates;
  SteadyClock::time_point ended;
  std::string state;
};

Watched watch(const test::Bench& bench, long id) {
  Watched watched;
  while (true) {
    const nlohmann::json scan = bench.scan(id);
    const auto now = SteadyClock::now();
    watched.state = scan.at("state");
    if (watched.state != "preparing" && watched.state != "running" && watched.state != "finishing" &&
        watched.state != "queued") {
      watched.ended = now;
      return watched;
    }
    if (!scan.at("remaining_s").is_null()) {
      watched.estimates.push_back({now, scan.at("accepted").get<double>() / scan.at("items").get<double>(),
                                   scan.at("remaining_s"), scan.at("u_remaining_s")});
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
  }
}

void print_times(const bench::ScanTimes& t) {
  const auto n = static_cast<double>(t.items);
  std::printf("\n%ld items, %ld visits, %ld frames; each part in s, and in ms an item\n", t.items, t.visits, t.frames);
  const auto row = [n](const char* name, double s) { std::printf("  %-22s %10.2f %10.3f\n", name, s, 1e3 * s / n); };
  row("moves (model)", t.move_s);
  row("settling (model)", t.settle_s);
  row("light", t.expose_s);
  row("must", t.must_s());
  row("wall", t.wall_s);
  row("beyond", t.wall_s - t.must_s());
  row("  frames read", t.read_s);
  row("  idle: commit", t.commit_s);
  row("  idle: wire", t.wire_s);
  row("  idle: device", t.device_s);
  row("  idle: hold", t.hold_s);
  row("  idle: planning", t.planning_s);
}

bool judge(const char* what, double value, double limit) {
  std::printf("%-34s %8.4f   limit %.2f   %s\n", what, value, limit, value <= limit ? "held" : "NOT HELD");
  return value <= limit;
}

bool judge_estimates(const Watched& watched, double dry_run_s, double wall_s) {
  std::printf("\n%6s %12s %12s %12s %10s\n", "done", "said [s]", "u [s]", "truth [s]", "off");
  double off_at_10 = 1.0;
  for (const double share : {0.02, 0.05, 0.1, 0.25, 0.5, 0.75}) {
    for (const Estimate& e : watched.estimates) {
      if (e.done < share) continue;
      const double truth = seconds_between(e.at, watched.ended);
      const double off = e.remaining_s / truth - 1.0;
      if (share == 0.1) off_at_10 = std::abs(off);
      std::printf("%5.0f%% %12.1f %12.1f %12.1f %9.2f%%\n", 100.0 * share, e.remaining_s, e.u_s, truth, 100.0 * off);
      break;
    }
  }
  std::printf("\ndry run %.1f s, scan %.1f s\n", dry_run_s, wall_s);
  const bool eta = judge("estimate at 10 % of the scan, off by", off_at_10, kEtaLimit);
  return judge("dry run, off by", std::abs(dry_run_s / wall_s - 1.0), kDryRunLimit) && eta;
}

int run(int points) {
  test::SceneOptions scene;
  scene.time_scale = 1.0;
  test::Bench bench(scene);
  bench.bring_up_daemon();
  const auto instrument = daemon::read_instrument(bench.files().instrument);
  if (!instrument) throw std::runtime_error(describe(instrument.error()));
  const std::string plan = step_plan(points);
  if (watch(bench, bench.submit(step_plan(kThetaSteps))).state != "done") throw std::runtime_error(bench.log());
  const test::HttpAnswer checked =
      bench.daemon().post("plans:check", nlohmann::json{{"plan", plan}, {"plan_file", "plan.toml"}}.dump());
  const nlohmann::json dry_run = nlohmann::json::parse(checked.body);
  const double dry_run_s = dry_run.at("estimate_s");
  std::printf("%d points of a step scan, dry run %.1f s (u %.1f s, by %d scans)\n", points, dry_run_s,
              dry_run.at("u_estimate_s").get<double>(), dry_run.at("learned_from_scans").get<int>());
  std::fflush(stdout);
  const long id = bench.submit(plan);
  const Watched watched = watch(bench, id);
  if (watched.state != "done") throw std::runtime_error("the scan ended " + watched.state + "\n" + bench.log());
  const bench::ScanTimes times = bench::read_scan_times(bench.files().store, id, instrument->stage);
  print_times(times);
  const bool estimates = judge_estimates(watched, dry_run_s, times.wall_s);
  const bool ratio = judge("wall / (moves + settling + light)", times.wall_s / times.must_s(), kRatioLimit);
  return ratio && estimates ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  const int points = argc > 1 ? std::atoi(argv[1]) : 2000;
  if (points < kThetaSteps || points % kThetaSteps != 0) {
    std::fprintf(stderr, "POINTS is a multiple of %d\n", kThetaSteps);
    return 2;
  }
  return run(points);
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
