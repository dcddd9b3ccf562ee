// A camera that bends, a shutter that opens longer than it says and arms that count from elsewhere: found by jobs,
// used, and a scan that was measured before computed anew, all through the programs that an operator has.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

// Exposures are wall time, 1 to 128 ms of a scene that runs 40 times as fast.
constexpr const char* kLadder = R"([scan]
name = "ladder"
sample = "tile"
[calibration]
job = "linearity"
[geometry]
theta_i_deg = [0]
theta_r_deg = [30]
phi_r_deg = [90]
wavelength_nm = [568]
repeats = 8
[reading]
max_time_s = 1
exposure_s = [2.5e-5, 5e-5, 1e-4, 2e-4, 4e-4, 8e-4, 1.6e-3, 3.2e-3]
[reference]
standard = "SRT-99-020"
block_s = 20
[visits]
dark_s = 10
)";

constexpr const char* kMirror = R"([scan]
name = "zeros of the arms"
sample = "mirror M1"
[calibration]
job = "arm-zeros"
wavelength_nm = 568
theta_i_deg = [15, 35, 55]
half_width_deg = 0.4
step_deg = 0.08
u_mirror_deg = 0.001
[reading]
target_snr = 200
max_time_s = 0.01
[reference]
standard = "SRT-99-020"
block_s = 60
[visits]
dark_s = 60
)";

constexpr const char* kTile = "model = \"glint\"\nslope_variance = 0.02\nrefractive_index = 1.5\n";
constexpr const char* kMirrorSurface =
    "[[sample.terms]]\nweight = 3e-5\nmodel = \"glint\"\nslope_variance = 3.43e-6\nrefractive_index = 1e12\n";

// What is wrong, and what the daemon is told of it: next to nothing.
constexpr const char* kWrong = R"([effects]
exposure_offset_s = 1e-4
[effects.response]
quadratic = -0.04
[angles]
u_zero_theta_i_deg = 0.06
u_zero_theta_r_deg = 0.06
u_zero_phi_r_deg = 0.06
u_repeat_deg = 0.002
[told]
u_linearity = 0.001
u_zero_theta_i_deg = 0.01
u_zero_theta_r_deg = 0.01
u_zero_phi_r_deg = 0.01
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

class Calibration : public testing::Test {
 protected:
  Calibration() : bench_(scene()) {
    // Heads so small that the mirror's normal can be crossed.
    std::string instrument = text_of(bench_.simulator().instrument_file());
    instrument = replaced(instrument, "detector_head_radius_mm = 20.0", "detector_head_radius_mm = 0.1");
    instrument = replaced(instrument, "source_head_radius_mm = 20.0", "source_head_radius_mm = 0.1");
    bench_.use_instrument(bench_.file("bare.toml", instrument));
    bench_.bring_up_daemon();
  }

  static SceneOptions scene() { return {.seed = 20260308, .sample = kTile, .more = kWrong}; }

  long run(const std::string& plan) {
    const Finished ended = bench_.gonioctl({"scan", "run", bench_.file("plan.toml", plan), "--watch"});
    EXPECT_EQ(ended.exit_code, 0) << ended.output << ended.errors << bench_.log();
    return bench_.get("scans").at("scans").at(0).at("id").get<long>();
  }
  std::string ask(const std::vector<std::string>& words) {
    const Finished done = bench_.gonioctl(words);
    EXPECT_EQ(done.exit_code, 0) << done.output << done.errors << bench_.log();
    return done.output;
  }
  // The version that a job's scan made: it is computed aside, after the scan is done.
  long version_of(const std::string& job) {
    long version = 0;
    const auto is_there = [&] {
      const nlohmann::json list = bench_.get("calibrations");
      for (const auto& one : list.at("calibrations")) {
        if (one.at("job") == job) version = one.at("version").get<long>();
      }
      return version != 0;
    };
    EXPECT_TRUE(eventually(is_there, std::chrono::seconds(20))) << job << bench_.log();
    return version;
  }
  // Another thing on the carriage: the simulator as by a power cycle, and a daemon on the same store.
  void mount(const std::string& sample) {
    EXPECT_EQ(bench_.end_daemon(), 0);
    bench_.simulator().kill();
    SceneOptions options = scene();
    options.sample = sample;
    std::string text = scene_text(options);
    if (sample.starts_with("[[")) text = replaced(text, "[sample]\n", "");
    write_text(bench_.scene_file(), text);
    bench_.simulator().restart();
    bench_.bring_up_daemon();
  }
  double chi_square_a_value(long id) {
    const Bench::MeasuredAndTrue tables = bench_.measured_and_true(id);
    double sum = 0.0;
    int values = 0;
    for (std::size_t k = 0; k < tables.measured.rows.size(); ++k) {
      const auto& row = tables.measured.rows[k];
      if (row.at("brdf_per_sr").empty()) continue;
      const double error = std::stod(row.at("brdf_per_sr")) - std::stod(tables.truth.rows[k].at("brdf_per_sr"));
      sum += std::pow(error / std::stod(row.at("u_per_sr")), 2);
      ++values;
    }
    return values == 0 ? 0.0 : sum / values;
  }

  Bench bench_;
};

TEST_F(Calibration, FoundByJobsMakesAnEarlierScanAgreeWithTheTruth) {
  const long scan =
      run(plan_text({.theta_i_deg = "[30]", .theta_r_deg = "[10, 20, 30, 40, 50]", .phi_r_deg = "[150, 180, 210]"}));
  const double before = chi_square_a_value(scan);
  (void)run(kLadder);
  mount(kMirrorSurface);  // at once: what the ladder tells may be found by this daemon or by the next
  const std::string ladder = std::to_string(version_of("linearity"));
  (void)ask({"calibration", "use", ladder, "--reason", "looked at"});
  (void)run(kMirror);
  const std::string zeros = std::to_string(version_of("arm-zeros"));
  (void)ask({"calibration", "use", zeros});
  mount(kTile);
  ASSERT_FALSE(HasFailure());

  const std::string shown = ask({"calibration", "show", ladder}) + ask({"calibration", "show", zeros});
  (void)ask({"scan", "recompute", std::to_string(scan)});

  const double after = chi_square_a_value(scan);
  EXPECT_GT(before, 20.0) << shown;
  EXPECT_LT(after, 4.0) << shown;
  std::printf("chi-square a value: %.1f by instrument.toml alone, %.2f with what the jobs found\n%s", before, after,
              shown.c_str());
  EXPECT_EQ(bench_.scan(scan).at("calibrations"), ladder + " " + zeros);
  (void)ask({"scan", "recompute", std::to_string(scan), "--calibration", "none"});
  EXPECT_NEAR(chi_square_a_value(scan), before, 1e-6 * before) << "what was computed first comes back to the digit";
}

}  // namespace
}  // namespace gonio::test
