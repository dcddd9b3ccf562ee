// goniosim: a simulated gonioreflectometer on real wires.
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/clock.h"
#include "sim/faults/fault_plan.h"
#include "sim/goniosim/child.h"
#include "sim/goniosim/find_scene.h"
#include "sim/goniosim/simulator.h"
#include "sim/goniosim/truth_table.h"
#include "sim/scene/drive_stage.h"
#include "sim/scene/read_scene.h"
#include "sim/wires/usb_bus.h"

namespace gonio::sim {
namespace {

constexpr int kUsage = 2;

struct Options {
  std::string scene;
  std::optional<std::uint64_t> seed;
  std::optional<double> time_scale;
  std::string state;
  WireWishes wishes;
  bool wants_drives = false;
  bool wants_truth = false;
  bool wants_faults = false;
  std::string points;
  std::vector<std::string> daemon;  ///< what stands after --
};

int fail(const Error& error) {
  fmt::print(stderr, "{}\n", explain(error));
  return traits(error.code).exit_code;
}

void describe_options(CLI::App& app, Options& options) {
  app.add_option("scene", options.scene, "a scene file, or the name of one that is installed");
  app.add_option("--seed", options.seed, "draw another truth and other noise than the scene says");
  app.add_option("--time-scale", options.time_scale, "scene seconds in one second")->check(CLI::Range(1e-3, 1e6));
  app.add_option("--state", options.state,
                 "folder for ports, positions, counters and the files for goniod; temporary if not given");
  const std::map<std::string, bool> wires{{"tcp", false}, {"rtu", true}};
  app.add_option("--stage-wire", options.wishes.wants_rtu,
                 "tcp, or rtu: a serial line behind STATE/stage.tty, 8 data bits, no parity, 2 stop bits")
      ->transform(CLI::CheckedTransformer(wires));
  const std::map<std::string, bool> stages{{"goniod", false}, {"drives", true}};
  app.add_option("--stage", options.wants_drives,
                 "goniod: one controller; or drives: a servo drive an axis (units 1 to 6) and a coupler (unit 20)")
      ->transform(CLI::CheckedTransformer(stages));
  app.add_option("--baud", options.wishes.stage_baud, "speed of that line, which the replies keep")
      ->check(CLI::IsMember({9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600}));
  app.add_option("--modbus-port", options.wishes.stage_port, "TCP port of the stage on 127.0.0.1");
  app.add_option("--camera-address", options.wishes.camera_address, "the camera's address, any of 127.0.0.0/8");
  CLI::App* truth = app.add_subcommand("truth", "print the sample's true BRDF at the rows of a CSV");
  truth->add_option("scene", options.scene, "as above")->required();
  truth->add_option("--seed", options.seed, "as above");
  truth
      ->add_option("--points", options.points,
                   "CSV with theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg; - reads the standard input")
      ->required();
  app.add_flag("--list-faults", options.wants_faults, "print the faults that a scene or the control socket can name");
  app.footer("In ARGS, {state} becomes the state folder. goniosim then ends with PROGRAM, and with its exit code.");
}

std::variant<Options, int> parse(int argc, char** argv) {
  Options options;
  std::vector<std::string> own(argv + 1, argv + argc);
  const auto dashes = std::ranges::find(own, "--");
  if (dashes != own.end()) {
    options.daemon.assign(dashes + 1, own.end());
    own.erase(dashes, own.end());
    if (options.daemon.empty()) {
      fmt::print(stderr, "goniosim: no program after --\n");
      return kUsage;
    }
  }
  CLI::App app(
      "A simulated gonioreflectometer: stage on Modbus TCP or RTU, camera on GigE Vision.\n"
      "  goniosim SCENE [--state DIR] [OPTIONS] [-- PROGRAM ARGS...]\n"
      "  goniosim truth SCENE [--seed N] --points FILE.csv",
      "goniosim");
  describe_options(app, options);
  try {
    std::ranges::reverse(own);  // CLI11 takes its arguments from the back
    app.parse(own);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  }
  options.wants_truth = app.got_subcommand("truth");
  if (options.wants_faults) {
    fmt::print("{}", fault_list());
    return 0;
  }
  if (!options.scene.empty()) return options;
  fmt::print(stderr, "goniosim: no scene named (see --help)\n");
  return kUsage;
}

Result<Scene> scene_of(const Options& options) {
  const auto path = find_scene(options.scene, this_executable());
  if (!path) return failure(path.error());
  auto scene = read_scene(*path);
  if (!scene) return scene;
  if (options.seed) scene->seed = *options.seed;
  if (options.time_scale) scene->time_scale = *options.time_scale;
  if (options.wants_drives) scene->stage.drives = drive_stage_of(scene->stage);
  return scene;
}

int print_truth(const Options& options) {
  const auto scene = scene_of(options);
  if (!scene) return fail(scene.error());
  std::ifstream file(options.points == "-" ? "/dev/stdin" : options.points);
  if (!file) {
    return fail({.code = ErrorCode::FileUnreadable,
                 .device = "goniosim",
                 .tried = "open the points",
                 .seen = "it does not exist or may not be read",
                 .where = InputLocation{options.points, 0, ""}});
  }
  const auto table = truth_table(*scene, file, options.points);
  if (!table) return fail(table.error());
  fmt::print("{}", *table);
  return 0;
}

/// A folder that is gone with its maker.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / ("goniosim-" + std::string(6, 'X'))).string();
    if (::mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Blocks the signals that `serve` reads, in this thread and all that it starts.
FileDescriptor take_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&signals, number);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return FileDescriptor(::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK));
}

// Until told to end, or until the child has ended. The exit code.
int serve(Simulator& simulator, const FileDescriptor& signals, const std::optional<Child>& child) {
  constexpr int kSaveEveryMs = 500;
  int requests = 0;
  for (;;) {
    pollfd watched{signals.get(), POLLIN, 0};
    ::poll(&watched, 1, kSaveEveryMs);
    signalfd_siginfo info{};
    while (::read(signals.get(), &info, sizeof info) == static_cast<ssize_t>(sizeof info)) {
      const int number = static_cast<int>(info.ssi_signo);
      if (number == SIGCHLD) continue;
      if (!child) return 0;
      child->signal(++requests == 1 ? number : SIGKILL);  // asked twice: it does not listen
    }
    if (child) {
      if (const auto code = child->ended()) return *code;
    }
    if (const auto saved = simulator.save(); !saved) spdlog::error("{}", describe(saved.error()));
  }
}

int simulate(Options options) {
  auto scene = scene_of(options);
  if (!scene) return fail(scene.error());
  const FileDescriptor signals = take_signals();
  std::optional<TemporaryFolder> temporary;
  if (options.state.empty()) temporary.emplace();
  const SystemClock clock;
  options.wishes.make_usb = [](const auto& radiometers) { return std::make_unique<UsbBus>(radiometers); };
  const auto simulator =
      Simulator::start(*std::move(scene), temporary ? temporary->path() : options.state, options.wishes, clock);
  if (!simulator) return fail(simulator.error());
  const WireAddresses& addresses = (*simulator)->addresses();
  const Scene& running = (*simulator)->instrument().scene();
  const std::string stage = addresses.stage_line.empty()
                                ? fmt::format("{}:{}", addresses.stage_host, addresses.stage_port)
                                : fmt::format("{} at {} baud", addresses.stage_line, addresses.stage_baud);
  spdlog::info("scene \"{}\", seed {}, {} scene seconds a second: stage on {}, camera on {}, files in {}", running.name,
               running.seed, running.time_scale, stage, addresses.camera_address, (*simulator)->folder().path());
  std::optional<Child> child;
  if (!options.daemon.empty()) {
    auto started =
        Child::start(options.daemon, this_executable(), (*simulator)->folder().path(), addresses.usb_environment);
    if (!started) return fail(started.error());
    child = *std::move(started);
  }
  return serve(**simulator, signals, child);
}

}  // namespace
}  // namespace gonio::sim

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("goniosim"));  // the standard output belongs to results
  const auto options = gonio::sim::parse(argc, argv);
  if (const int* code = std::get_if<int>(&options)) return *code;
  const auto& wanted = std::get<gonio::sim::Options>(options);
  return wanted.wants_truth ? gonio::sim::print_truth(wanted) : gonio::sim::simulate(wanted);
}
