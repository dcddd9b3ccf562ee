#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/scenario/csv_table.h"
#include "tests/scenario/daemon.h"
#include "tests/scenario/simulator.h"
#include "tests/support/http_client.h"
#include "tests/support/process.h"

namespace gonio::test {

/// What a test's own scene says; the rest is the bench of sim/scenes.
struct SceneOptions {
  double time_scale = 40.0;
  bool draw_errors = true;
  std::uint64_t seed = 1;
  std::string sample = "model = \"lambertian\"\nrho = 0.5\n";
  std::string stage_wire = "tcp";  ///< or "rtu"; of the simulator, not of the scene's file
  std::string stage = "goniod";    ///< our own controller, or "drives"
  std::string more{};              ///< sections that are added to the scene's file
  long history = 0;                ///< moves and exposures that the simulator remembers: noise starts after them
};
/// A card on the bench of sim/scenes.
[[nodiscard]] std::string scene_text(const SceneOptions& options);

/// The lists of a small plan on the scenes' reference at 568 nm.
struct PlanOptions {
  std::string theta_i_deg = "[0, 30]";
  std::string theta_r_deg = "[0, 30, 60]";
  std::string phi_r_deg = "[0, 90, 180]";
  std::string points{};  ///< a file of points beside the plan, in place of the lists
  std::string strategy = "fastest";
  double target_snr = 100.0;
  int block_s = 20;  ///< and dark_s: what is due by time depends on how busy the machine is
  int dark_s = 10;
  std::string exposure_s{};  ///< stated: "[0.001, 0.016]"; empty: chosen
  std::string on_item_error = "retry 2, then skip";
  std::string visits{};  ///< more lines of [visits]
};
[[nodiscard]] std::string plan_text(const PlanOptions& options);

/// One simulator and at most one daemon below one temporary folder, and what an operator does with them.
/// Everything that does not come within its bound throws std::runtime_error with what the programs said.
class Bench {
 public:
  explicit Bench(const SceneOptions& scene);
  /// On a scene file that exists.
  Bench(const std::string& scene_file, std::uint64_t seed);

  [[nodiscard]] const Simulator& simulator() const { return *simulator_; }
  [[nodiscard]] Simulator& simulator() { return *simulator_; }
  [[nodiscard]] Daemon& daemon() { return *daemon_; }
  [[nodiscard]] const DaemonFiles& files() const { return files_; }
  [[nodiscard]] const std::string& folder() const { return folder_.path(); }
  [[nodiscard]] const std::string& scene_file() const { return scene_file_; }
  /// Writes a file below the folder; its path.
  [[nodiscard]] std::string file(const std::string& name, const std::string& text) const;

  /// The next daemon is to find its reference standards there.
  void use_references(const std::string& folder) { files_.references = folder; }
  /// The next daemon is to find its instrument there.
  void use_instrument(const std::string& file) { files_.instrument = file; }
  /// The next daemon is to record to this file.
  void record_to(const std::string& tape) { files_.tape = tape; }
  /// A new daemon on the same store, not waited for. One before it is killed.
  void start_daemon();
  /// A new daemon on the same store, answering.
  void bring_up_daemon();
  /// Finds the stage's home, as it must be before a move by hand.
  void home();
  /// Ends the daemon in an orderly way; its exit code.
  int end_daemon();

  /// gonioctl, told where the daemon is.
  [[nodiscard]] Finished gonioctl(std::vector<std::string> arguments) const;
  /// What GET answers, which must be 200.
  [[nodiscard]] nlohmann::json get(const std::string& path) const;
  [[nodiscard]] nlohmann::json scan(long id) const;
  [[nodiscard]] std::string state_of(long id) const;
  /// The names of the holds that the scan has, with their reasons.
  [[nodiscard]] std::string holds_of(long id) const;

  /// Submits over REST; the scan's number.
  [[nodiscard]] long submit(const std::string& plan) const;
  /// Clears the stage's latch, then resumes: what an operator does once the cause is gone. Asked again while the
  /// device is still coming back.
  void reset_and_resume(long id) const;
  /// The same once, and only if the scan is on hold: for an operator who looks in now and then.
  void help_if_on_hold(long id) const;
  /// Waits until the scan's state is one of `states`; the state.
  std::string wait_for_state(long id, const std::vector<std::string>& states) const;

  /// The scan as `gonioctl data export` writes it, and what the simulator knows of the same points.
  struct MeasuredAndTrue {
    CsvTable measured;
    CsvTable truth;
  };
  [[nodiscard]] CsvTable exported(long id) const;
  [[nodiscard]] MeasuredAndTrue measured_and_true(long id) const;

  /// What the programs said last, for the message of a failed test.
  [[nodiscard]] std::string log() const;

 private:
  TemporaryFolder folder_;
  std::string scene_file_;
  std::uint64_t seed_;
  std::unique_ptr<Simulator> simulator_;
  DaemonFiles files_;
  std::unique_ptr<Daemon> daemon_;
};

/// Every value lies within 5 U of the truth, 10 standard uncertainties: chance never gets there, a wrong factor, dark,
/// sign or angle does. The number of values.
int expect_agreement(const Bench::MeasuredAndTrue& tables);

/// "item-accepted" events of a list, each as (point, target).
[[nodiscard]] std::vector<std::string> accepted_items(const std::vector<ServerEvent>& events);
[[nodiscard]] long count_of(const std::vector<ServerEvent>& events, const std::string& kind);
/// Whether the numbers go up by one from `first`.
[[nodiscard]] bool is_gapless_from(long first, const std::vector<ServerEvent>& events);
/// All events that the daemon has, by a new client that starts from nothing.
[[nodiscard]] std::vector<ServerEvent> all_events(const Bench& bench, int port);

}  // namespace gonio::test
