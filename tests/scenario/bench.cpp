#include "tests/scenario/bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "tests/scenario/programs.h"

namespace gonio::test {

using nlohmann::json;

std::string scene_text(const SceneOptions& options) {
  std::ostringstream text;
  text << std::boolalpha << "[scene]\nname = \"scenario\"\nbench = \"" << kScenes
       << "/bench.toml\"\nseed = " << options.seed << "\ntime_scale = " << std::showpoint << options.time_scale
       << "\ndraw_errors = " << options.draw_errors << "\n[sample]\n"
       << options.sample << options.more;
  return text.str();
}

std::string plan_text(const PlanOptions& options) {
  const std::string lists = "theta_i_deg = " + options.theta_i_deg + "\ntheta_r_deg = " + options.theta_r_deg +
                            "\nphi_r_deg = " + options.phi_r_deg + "\n";
  std::ostringstream text;
  text << "[scan]\nname = \"scenario\"\nsample = \"card\"\n[geometry]\n"
       << (options.points.empty() ? lists : "points = \"" + options.points + "\"\n") << "wavelength_nm = [568]\n"
       << "[reading]\ntarget_snr = " << options.target_snr << "\nmax_time_s = 0.5\n"
       << (options.exposure_s.empty() ? "" : "exposure_s = " + options.exposure_s + "\n")
       << "[reference]\nstandard = \"SRT-99-020\"\nmode = \"same-geometry\"\nblock_s = " << options.block_s << "\n"
       << "[visits]\ndark_s = " << options.dark_s << "\n"
       << options.visits << "[order]\nstrategy = \"" << options.strategy << "\"\n"
       << "[on_error]\nitem = \"" << options.on_item_error << "\"\n[on_restart]\npolicy = \"resume\"\n";
  return text.str();
}

Bench::Bench(const SceneOptions& scene) : scene_file_(folder_ / "scene.toml"), seed_(scene.seed) {
  write_text(scene_file_, scene_text(scene));
  simulator_ = std::make_unique<Simulator>(folder_.path(), scene_file_, scene.seed, scene.stage_wire, scene.history,
                                           scene.stage);
  files_ = {simulator_->instrument_file(), simulator_->reference_folder(), folder_ / "store.sqlite"};
}

Bench::Bench(const std::string& scene_file, std::uint64_t seed) : scene_file_(scene_file), seed_(seed) {
  simulator_ = std::make_unique<Simulator>(folder_.path(), scene_file_, seed);
  files_ = {simulator_->instrument_file(), simulator_->reference_folder(), folder_ / "store.sqlite"};
}

std::string Bench::file(const std::string& name, const std::string& text) const {
  const std::string path = folder_ / name;
  write_text(path, text);
  return path;
}

void Bench::start_daemon() {
  daemon_.reset();
  daemon_ = std::make_unique<Daemon>(files_, folder_.path(), simulator_->usb_environment());
}

void Bench::bring_up_daemon() {
  start_daemon();
  daemon_->wait_until_ready();
}

void Bench::home() {
  const HttpAnswer answer = daemon_->post("stage/home");
  if (answer.status / 100 != 2) throw std::runtime_error("the stage did not home: " + answer.body + "\n" + log());
}

int Bench::end_daemon() {
  const int code = daemon_->end();
  daemon_.reset();
  return code;
}

Finished Bench::gonioctl(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), {kGonioctl, "--connect", daemon_->url()});
  return run_program(arguments, folder_.path(), kStepDeadline);
}

json Bench::get(const std::string& path) const {
  const HttpAnswer answer = daemon_->get(path);
  if (answer.status == 200) return json::parse(answer.body);
  throw std::runtime_error("GET " + path + ": " + std::to_string(answer.status) + " " + answer.body + "\n" + log());
}

json Bench::scan(long id) const {
  return get("scans/" + std::to_string(id));
}

std::string Bench::state_of(long id) const {
  return scan(id).at("state").get<std::string>();
}

std::string Bench::holds_of(long id) const {
  const json report = scan(id);
  std::string text;
  for (const json& hold : report.at("holds")) {
    text += hold.at("name").get<std::string>() + ": " + hold.at("reason").get<std::string>() + "\n";
  }
  return text;
}

long Bench::submit(const std::string& plan) const {
  const HttpAnswer answer = daemon_->post("scans", json{{"plan", plan}, {"plan_file", "plan.toml"}}.dump());
  if (answer.status / 100 == 2) return json::parse(answer.body).at("scan").get<long>();
  throw std::runtime_error("POST scans: " + std::to_string(answer.status) + " " + answer.body + "\n" + log());
}

void Bench::reset_and_resume(long id) const {
  const std::string resume = "scans/" + std::to_string(id) + "/resume";
  HttpAnswer answer;
  const auto is_resumed = [&] {
    (void)daemon_->post("stage/reset");
    answer = daemon_->post(resume);
    return answer.status / 100 == 2 || state_of(id) != "holding";  // its hold may have ended by itself
  };
  if (eventually(is_resumed, kStepDeadline)) return;
  throw std::runtime_error("the scan did not resume: " + answer.body + "\n" + log());
}

void Bench::help_if_on_hold(long id) const {
  const std::string path = "scans/" + std::to_string(id);
  const HttpAnswer answer = daemon_->get(path);
  if (answer.status != 200 || json::parse(answer.body).at("state") != "holding") return;
  (void)daemon_->post("stage/reset");
  (void)daemon_->post(path + "/resume");
}

std::string Bench::wait_for_state(long id, const std::vector<std::string>& states) const {
  std::string state;
  const auto is_there = [&] {
    state = state_of(id);
    return std::ranges::find(states, state) != states.end();
  };
  if (eventually(is_there, kScanDeadline)) return state;
  throw std::runtime_error("the scan stayed " + state + "; " + holds_of(id) + log());
}

CsvTable Bench::exported(long id) const {
  const std::string file = folder_ / "scan.csv";
  const Finished run = gonioctl({"data", "export", std::to_string(id), "--format", "csv", "-o", file});
  if (run.exit_code != 0) throw std::runtime_error("no export: " + run.output + run.errors + log());
  return parse_csv(text_of(file));
}

Bench::MeasuredAndTrue Bench::measured_and_true(long id) const {
  CsvTable measured = exported(id);
  const Finished run =
      run_program({kGoniosim, "truth", scene_file_, "--seed", std::to_string(seed_), "--points", folder_ / "scan.csv"},
                  folder_.path(), kStepDeadline);
  if (run.exit_code != 0) throw std::runtime_error("no truth: " + run.errors);
  return {.measured = std::move(measured), .truth = parse_csv(run.output)};
}

std::string Bench::log() const {
  return tail_of(folder_ / "goniosim.log") + tail_of(folder_ / "goniod.log");
}

int expect_agreement(const Bench::MeasuredAndTrue& tables) {
  const auto& measured = tables.measured.rows;
  EXPECT_EQ(tables.truth.rows.size(), measured.size());
  int compared = 0;
  for (std::size_t i = 0; i < std::min(measured.size(), tables.truth.rows.size()); ++i) {
    EXPECT_EQ(tables.truth.rows[i].at("point"), measured[i].at("point"));
    if (measured[i].at("brdf_per_sr").empty()) continue;
    ++compared;
    const double truth_per_sr = std::stod(tables.truth.rows[i].at("brdf_per_sr"));
    EXPECT_GT(truth_per_sr, 0.0);
    EXPECT_NEAR(std::stod(measured[i].at("brdf_per_sr")), truth_per_sr,
                5.0 * std::stod(measured[i].at("expanded_u_per_sr")))
        << "point " << measured[i].at("point");
  }
  return compared;
}

std::vector<std::string> accepted_items(const std::vector<ServerEvent>& events) {
  std::vector<std::string> items;
  for (const ServerEvent& event : events) {
    if (event.kind != "item-accepted") continue;
    const json data = json::parse(event.data).at("data");
    items.push_back(data.at("point").dump() + " " + data.at("target").get<std::string>());
  }
  return items;
}

long count_of(const std::vector<ServerEvent>& events, const std::string& kind) {
  return std::ranges::count(events, kind, &ServerEvent::kind);
}

bool is_gapless_from(long first, const std::vector<ServerEvent>& events) {
  long expected = first;
  return std::ranges::all_of(events, [&](const ServerEvent& event) { return event.number == expected++; });
}

std::vector<ServerEvent> all_events(const Bench& bench, int port) {
  const long last = bench.get("status").at("last_event").get<long>();
  EventReader reader(port, 0);
  reader.wait_for([&](const auto& events) { return !events.empty() && events.back().number >= last; }, kStepDeadline);
  return reader.events();
}

}  // namespace gonio::test
