#include "tests/scenario/simulator.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

using nlohmann::json;

// Different for each simulator of each test program that runs at the same time: from the process and a count.
std::string own_camera_address() {
  static std::atomic<unsigned> count{0};
  const unsigned number = (static_cast<unsigned>(getpid()) * 16U + count++ % 16U) & 0x3fffffU;
  return "127." + std::to_string(64U + (number >> 16U)) + "." + std::to_string((number >> 8U) & 0xffU) + "." +
         std::to_string(number & 0xffU);
}

std::string made(const std::string& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

// As a simulator that has moved and exposed so often left its folder.
std::string with_history(const std::string& state_folder, long history) {
  if (history == 0) return state_folder;
  const json state{
      {"boot_counter", 1},        {"positions", json::array()}, {"moves", history},        {"exposures", history},
      {"lit_exposures", history}, {"scene_time_s", 0.0},        {"places", json::array()}, {"stage_port", 0},
      {"camera_address", ""}};
  write_text(state_folder + "/state.json", state.dump());
  return state_folder;
}

int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) throw std::runtime_error("too long for a socket: " + path);
  std::memcpy(address.sun_path, path.data(), path.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd >= 0 && connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  if (fd >= 0) close(fd);
  return -1;
}

// One line there, one line back.
std::string exchange(const std::string& path, const std::string& line) {
  const int fd = connect_to(path);
  if (fd < 0) return {};
  std::string answer;
  const std::string request = line + "\n";
  if (send(fd, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size())) {
    constexpr int kLongestWaitMs = 30'000;
    pollfd waiting{fd, POLLIN, 0};
    char buffer[16384];
    while (answer.find('\n') == std::string::npos && poll(&waiting, 1, kLongestWaitMs) > 0) {
      const ssize_t n = recv(fd, buffer, sizeof buffer, 0);
      if (n <= 0) break;
      answer.append(buffer, static_cast<std::size_t>(n));
    }
  }
  close(fd);
  return answer.substr(0, answer.find('\n'));
}

}  // namespace

Simulator::Simulator(const std::string& folder, const std::string& scene_file, std::uint64_t seed,
                     const std::string& stage_wire, long history, const std::string& stage)
    : state_(with_history(made(folder + "/bench"), history)),
      log_(folder + "/goniosim.log"),
      command_({kGoniosim, scene_file, "--state", state_, "--seed", std::to_string(seed), "--camera-address",
                own_camera_address(), "--stage-wire", stage_wire, "--stage", stage}),
      process_(command_, log_) {
  wait_until_ready();
}

void Simulator::restart() {
  process_ = Process(command_, log_);
  wait_until_ready();
}

// One that was killed leaves its ready file behind: only its own counts.
void Simulator::wait_until_ready() {
  const auto is_ready = [&] {
    const std::string ready = state_ + "/ready";
    if (!std::filesystem::exists(ready)) return false;
    const json said = json::parse(text_of(ready), nullptr, false);
    return said.is_object() && said.value("pid", -1) == process_.pid();
  };
  if (eventually([&] { return is_ready() || !process_.is_running(); }, kStartDeadline) && process_.is_running()) return;
  throw std::runtime_error("goniosim did not come up. " + tail_of(log_));
}

std::string Simulator::ask(const std::string& line) const {
  std::string answer = exchange(state_ + "/control.sock", line);
  if (answer.empty()) throw std::runtime_error("goniosim did not answer " + line + ". " + tail_of(log_));
  return answer;
}

void Simulator::order(const std::string& line) const {
  const std::string answer = ask(line);
  if (!json::parse(answer).value("ok", false)) throw std::runtime_error("goniosim refused " + line + ": " + answer);
}

std::vector<std::string> Simulator::usb_environment() const {
  std::vector<std::string> settings;
  const json ready = json::parse(text_of(state_ + "/ready"));
  for (const auto& [name, value] : ready.at("usb_environment").items()) {
    settings.push_back(name + "=" + value.get<std::string>());
  }
  // A program with the address sanitizer in it wants to come first; what is put before it here is no rival.
  const char* set = std::getenv("ASAN_OPTIONS");
  if (!settings.empty()) {
    settings.push_back(std::string("ASAN_OPTIONS=verify_asan_link_order=0:") + (set == nullptr ? "" : set));
  }
  return settings;
}

SeenStage Simulator::stage() const {
  const json answer = json::parse(ask(R"({"query":"stage"})"));
  SeenStage stage{.axes = {},
                  .moving = answer.at("moving"),
                  .homed = answer.at("homed"),
                  .halted = answer.at("halted"),
                  .heartbeat_tripped = answer.at("heartbeat_tripped"),
                  .fault = answer.at("fault"),
                  .boot_counter = answer.at("boot_counter"),
                  .motion_commands = answer.at("motion_commands"),
                  .shutter_commands = answer.at("shutter_commands")};
  for (const auto& [name, axis] : answer.at("axes").items()) {
    stage.axes[name] = {.position = axis.at("position"),
                        .target = axis.at("target"),
                        .moving = axis.at("moving"),
                        .homed = axis.at("homed")};
  }
  return stage;
}

SeenExposures Simulator::exposures() const {
  const json answer = json::parse(ask(R"({"query":"exposures"})"));
  SeenExposures seen{.total = answer.at("exposures"), .dark = 0, .lit = {}};
  seen.dark = seen.total - answer.at("lit_exposures").get<long>();
  for (const json& place : answer.at("by_geometry")) {
    if (!place.at("lit").get<bool>()) continue;
    seen.lit.push_back({.station = place.at("station"),
                        .theta_i_deg = place.at("theta_i_deg"),
                        .theta_r_deg = place.at("theta_r_deg"),
                        .phi_r_deg = place.at("phi_r_deg"),
                        .count = place.at("exposures")});
  }
  return seen;
}

void Simulator::silence_camera(bool on) const {
  order(json{{"fault", "camera-silent"}, {"on", on}}.dump());
}

void Simulator::silence_stage(bool on) const {
  order(json{{"fault", "stage-silent"}, {"on", on}}.dump());
}

void Simulator::refuse_stage(bool on) const {
  order(json{{"fault", "stage-refuse"}, {"on", on}}.dump());
}

std::string Simulator::fault(const std::string& name, const std::string& keys) const {
  const std::string line = R"({"fault":")" + name + '"' + (keys.empty() ? "" : ",") + keys + "}";
  std::string answer = ask(line);
  if (!json::parse(answer).value("ok", false)) throw std::runtime_error("goniosim refused " + line + ": " + answer);
  return answer;
}

void Simulator::end_fault(const std::string& name) const {
  order(json{{"fault", name}, {"on", false}}.dump());
}

void Simulator::block_axis(const std::string& axis, bool on) const {
  order(json{{"fault", "axis-blocked"}, {"axis", axis}, {"on", on}}.dump());
}

void Simulator::open_interlock(bool on) const {
  order(json{{"fault", "interlock-open"}, {"on", on}}.dump());
}

}  // namespace gonio::test
