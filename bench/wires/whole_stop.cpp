// STOP of a whole goniod: from the last byte of the HTTP request to the whole halt frame at the stage, on Modbus TCP
// and on a serial line at 115200 baud, in every state, alone and with 200 clients on the API; and whether anything that
// was decided before moves anything after. Between goniod and goniosim stands a tap that notes when frames pass. The
// limit is 50 ms in every state. Ends with 1 where a stop is beyond it or something moves. Usage: bench_stop_whole
// [STOPS A STATE]
#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sqlite3.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/wires/api_load.h"
#include "bench/wires/stage_tap.h"
#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace {

using namespace gonio;
using nlohmann::json;
using test::eventually;
using test::kStepDeadline;

constexpr double kLimitMs = 50.0;
// A homing from nearby may be over before it is seen; the stop then meets a stage that has just arrived.
constexpr std::chrono::seconds kMotionDeadline{2};
constexpr int kEventClients = 100;
constexpr int kStatusClients = 100;

constexpr double kBaud = 115200.0;  // as goniosim's line
// A pseudo terminal hands bytes on at once; on a line the frame's 13 bytes take their time.
constexpr double kSerialFrameMs = 13 * 11 * 1e3 / kBaud;

// Long moves, exposures of an eighth of a second: each state lasts longer than it takes to find out about it. Items
// that fail because their link was kept back are tried again, so that the plan lasts.
constexpr double kTimeScale = 4.0;
const test::PlanOptions kPlan{.theta_i_deg = "[10, 70]",
                              .theta_r_deg = "[0, 50, 20, 70, 30, 60, 10, 40]",
                              .phi_r_deg = "[180, 60, 150, 90]",
                              .strategy = "as-written",
                              .block_s = 2,
                              .dark_s = 600,
                              .exposure_s = "[0.128]",
                              .on_item_error = "retry 10, then skip"};

/// Somebody else's transaction on the store's file: goniod's next commit waits.
class ForeignLock {
 public:
  explicit ForeignLock(const std::string& store) {
    sqlite3_open(store.c_str(), &database_);
    sqlite3_busy_timeout(database_, 5000);
    sqlite3_exec(database_, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr);
  }
  ForeignLock(const ForeignLock&) = delete;
  ForeignLock& operator=(const ForeignLock&) = delete;
  ~ForeignLock() {
    sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
    sqlite3_close(database_);
  }

 private:
  sqlite3* database_ = nullptr;
};

struct Stopped {
  double ms = -1.0;           ///< negative: the halt never came
  long accepted_motions = 0;  ///< by the stage, after it
  long sent_motions = 0;      ///< to the stage, after it
};

/// One goniod on one goniosim, with a tap between, and what brings it into each state.
class House {
 public:
  /// On `wire`: "tcp" or "rtu".
  explicit House(const std::string& wire)
      : bench_({.time_scale = kTimeScale, .stage_wire = wire}), is_serial_(wire == "rtu") {
    const json ready = json::parse(test::text_of(bench_.simulator().state_folder() + "/ready"));
    if (is_serial_) {
      const std::string line = ready.at("stage_line");
      tap_ = std::make_unique<bench::StageTap>(line + ".tap", line);
      lead_daemon_to_tap(fmt::format("address = \"{}\"\n", line), fmt::format("address = \"{}.tap\"\n", line));
    } else {
      const std::uint16_t port = ready.at("stage_port");
      tap_ = std::make_unique<bench::StageTap>(port);
      lead_daemon_to_tap(fmt::format("port = {}\n", port), fmt::format("port = {}\n", tap_->port()));
    }
    bench_.bring_up_daemon();
  }

  test::Bench& bench() { return bench_; }
  bench::StageTap& tap() { return *tap_; }

  Stopped stop() {
    const int fd = connected();
    const std::string request = fmt::format(
        "POST /api/v1/stop HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: application/json\r\nContent-Length: 2\r\n"
        "Connection: close\r\n\r\n{{}}",
        bench_.daemon().port());
    tap_->expect_halt();
    const Instant asked = clock_.now();
    (void)::send(fd, request.data(), request.size(), MSG_NOSIGNAL);
    const auto came = tap_->halt_came();
    // The tap has seen the halt before the stage has: what the stage took first was not accepted after it.
    test::SeenStage at_halt;
    const auto is_halted = [&] {
      at_halt = bench_.simulator().stage();
      return at_halt.halted;
    };
    const bool was_halted = came && eventually(is_halted, kStepDeadline);
    ::close(fd);
    if (!was_halted) return {};
    const bool stands = eventually([&] { return !bench_.simulator().stage().moving; }, kStepDeadline);
    // Ten answers later everything that was under way has had its turn.
    for (int k = 0; k < 10; ++k) (void)doing();
    const long accepted = bench_.simulator().stage().motion_commands - at_halt.motion_commands;
    return {.ms = in_seconds(*came - asked) * 1e3 + (is_serial_ ? kSerialFrameMs : 0.0),
            .accepted_motions = stands ? accepted : accepted + 1,
            .sent_motions = tap_->motions_since_halt()};
  }

  // ---- ways into a state ----

  void reset() { (void)bench_.daemon().post("stage/reset"); }
  /// Asked until it is answered: goniod turns away what its workers cannot take.
  [[nodiscard]] std::string doing() {
    test::HttpAnswer answer;
    (void)eventually(
        [&] {
          answer = bench_.daemon().get("status");
          return answer.status == 200;
        },
        kStepDeadline);
    return json::parse(answer.body).at("doing");
  }
  void await_doing(const std::string& what) {
    if (!eventually([&] { return doing() == what; }, kStepDeadline))
      throw std::runtime_error("goniod was never " + what + ". " + bench_.log());
  }
  void await_no_longer(const std::string& what) {
    (void)eventually([&] { return doing() != what; }, kStepDeadline);
  }
  void await_motion() {
    (void)eventually([&] { return bench_.simulator().stage().moving; }, kMotionDeadline);
  }
  /// A scan that runs or is about to.
  void scan() {
    if (scan_ == 0 || bench_.state_of(scan_) == "done") {
      reset();
      scan_ = bench_.submit(test::plan_text(kPlan));
    } else {
      hold();
      bench_.reset_and_resume(scan_);
    }
  }
  void hold() {
    (void)bench_.daemon().post(fmt::format("scans/{}/pause", scan_));
    (void)bench_.wait_for_state(scan_, {"holding", "done"});
  }
  void abort_scan() {
    if (scan_ != 0) (void)bench_.daemon().post(fmt::format("scans/{}/abort", scan_));
    scan_ = 0;
  }
  /// A command by hand on a thread of its own, since it is answered at its end.
  void by_hand(const std::string& path, const std::string& body) {
    end_by_hand();
    hand_ = std::jthread([this, path, body] { (void)bench_.daemon().post(path, body); });
  }
  void end_by_hand() {
    if (hand_.joinable()) hand_.join();
  }

 private:
  // By the line of instrument.toml that says where the stage is.
  void lead_daemon_to_tap(const std::string& stage, const std::string& tap) {
    std::string text = test::text_of(bench_.simulator().instrument_file());
    const std::size_t at = text.find(stage);
    if (at == std::string::npos) throw std::runtime_error("instrument.toml does not say: " + stage);
    text.replace(at, stage.size(), tap);
    bench_.use_instrument(bench_.file("instrument.toml", text));
  }
  [[nodiscard]] int connected() {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(bench_.daemon().port()));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("no goniod. " + bench_.log());
    return fd;
  }

  test::Bench bench_;
  bool is_serial_;
  std::unique_ptr<bench::StageTap> tap_;
  SystemClock clock_;
  long scan_ = 0;
  std::jthread hand_;
};

struct State {
  std::string name;
  std::function<void(House&)> reach;
  std::function<void(House&)> leave = [](House&) {};
};

void move_by_hand(House& house, int k) {
  house.reset();
  house.by_hand("stage/move", k % 2 == 0 ? R"({"theta_i_deg":80.0})" : R"({"theta_i_deg":5.0})");
  house.await_motion();
}

std::vector<State> states() {
  std::vector<State> all;
  all.push_back({"idle", [](House& h) { h.reset(); }});
  all.push_back({"moved by hand",
                 [k = 0](House& h) mutable {
                   if (k == 0) {
                     h.reset();
                     h.bench().home();
                   }
                   move_by_hand(h, k++);
                 },
                 [](House& h) { h.end_by_hand(); }});
  all.push_back({"homing by hand",
                 [](House& h) {
                   h.reset();
                   h.by_hand("stage/home", "{}");
                   h.await_motion();
                 },
                 [](House& h) { h.end_by_hand(); }});
  all.push_back({"scan: preparing", [](House& h) { h.scan(); }});
  for (const std::string doing : {"moving", "exposing"}) {
    all.push_back({"scan: " + doing, [doing](House& h) {
                     h.scan();
                     h.await_doing(doing);
                   }});
  }
  all.push_back({"scan: holding", [](House& h) {
                   h.scan();
                   h.hold();
                 }});
  all.push_back({"scan: the stage's link waits out a timeout",
                 [](House& h) {
                   h.scan();
                   h.await_doing("moving");
                   h.tap().keep_back(true);
                   (void)h.tap().await_kept_back();
                 },
                 [](House& h) { h.tap().keep_back(false); }});
  auto lock = std::make_shared<std::optional<ForeignLock>>();
  all.push_back({"scan: the store is stalled",
                 [lock](House& h) {
                   h.scan();
                   h.await_doing("exposing");
                   lock->emplace(h.bench().files().store);
                   h.await_no_longer("exposing");  // its commit is asked for, and waits
                 },
                 [lock](House&) { lock->reset(); }});
  return all;
}

bool report(const std::string& what, std::vector<Stopped> stops) {
  std::ranges::sort(stops, {}, &Stopped::ms);
  const auto at = [&](double share) {
    return stops[static_cast<std::size_t>(share * static_cast<double>(stops.size() - 1))].ms;
  };
  long accepted = 0;
  long sent = 0;
  for (const Stopped& one : stops) {
    accepted += one.accepted_motions;
    sent += one.sent_motions;
  }
  const bool holds = stops.front().ms >= 0.0 && stops.back().ms <= kLimitMs && accepted == 0;
  fmt::print("{:<58} {:>5} {:>8.2f} {:>8.2f} {:>8.2f} {:>6} {:>9}  {}\n", what, stops.size(), at(0.5), at(0.99),
             stops.back().ms, sent, accepted, holds ? "holds" : "DOES NOT HOLD");
  std::fflush(stdout);
  return holds;
}

bool run(const std::string& wire, int stops_a_state) {
  fmt::print("{:<58} {:>5} {:>8} {:>8} {:>8} {:>6} {:>9}\n",
             wire == "rtu" ? "Modbus RTU: ms from the request's last byte to the halt"
                           : "Modbus TCP: ms from the request's last byte to the halt",
             "stops", "median", "99 %", "worst", "sent", "accepted");
  bool all_hold = true;
  std::vector<Stopped> all;
  House house(wire);
  for (const bool is_loaded : {false, true}) {
    std::optional<bench::ApiLoad> load;
    if (is_loaded) load.emplace(house.bench().daemon().port(), kEventClients, kStatusClients);
    for (const State& state : states()) {
      std::vector<Stopped> stops;
      for (int k = 0; k < stops_a_state; ++k) {
        state.reach(house);
        stops.push_back(house.stop());
        state.leave(house);
      }
      all.insert(all.end(), stops.begin(), stops.end());
      all_hold = report(state.name + (is_loaded ? ", 200 clients" : ""), stops) && all_hold;
    }
    house.abort_scan();
    if (load)
      fmt::print("the clients had {} kB of events and {} answers\n", load->event_bytes() / 1000, load->answers());
  }
  return report("all", all) && all_hold;
}

}  // namespace

int main(int argc, char** argv) {
  const int stops = argc > 1 ? std::max(1, std::atoi(argv[1])) : 20;
  try {
    const bool on_tcp = run("tcp", stops);
    return run("rtu", stops) && on_tcp ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& trouble) {
    fmt::print(stderr, "{}\n", trouble.what());
    return EXIT_FAILURE;
  }
}
