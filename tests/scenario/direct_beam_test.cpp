// A sample measured without any standard: the job reads the direct beam through an attenuator, a person takes it into
// use, and absolute mode then says what is true. Attenuator, stop and arms are other than their papers say.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

constexpr const char* kBeamPlan = R"([scan]
name = "direct beam"
sample = "nothing"
[calibration]
job = "direct-beam"
wavelength_nm = [568]
theta_i_deg = 80
beside_deg = 0.1
repeats = 3
[reading]
target_snr = 1000
max_time_s = 0.5
[reference]
standard = "SRT-99-020"
[visits]
dark_s = 20
)";

constexpr const char* kCardPlan = R"([scan]
name = "card, absolute"
sample = "card"
[geometry]
theta_i_deg = [10, 40]
theta_r_deg = [0, 20, 40, 60]
phi_r_deg = [90, 180]
wavelength_nm = [568]
[reading]
target_snr = 500
max_time_s = 0.5
[reference]
standard = "SRT-99-020"
mode = "absolute"
[visits]
dark_s = 20
)";

constexpr const char* kOptics = R"([effects.overlap]
spot_radius_mm = 3.0
field_radius_mm = 6.0
[effects.stop]
radius_mm = 10.0
u_radius_mm = 0.01
distance_mm = 500.0
u_distance_mm = 0.25
)";

constexpr const char* kAttenuator = R"(
[[filters]]
slot = 4
centroid_nm = 568.0
fwhm_nm = 10.0
out_of_band_fraction = 1e-5
attenuation = 1e-3
u_attenuation = 2e-6
)";

std::string with(std::string text, const std::string& before, const std::string& from, const std::string& to) {
  const std::size_t section = text.find(before);
  const std::size_t at = section == std::string::npos ? section : text.find(from, section);
  EXPECT_NE(at, std::string::npos) << before << " " << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// The bench of sim/scenes with an arm that reaches beyond the horizon, a place where nothing stands in the beam, and an
// attenuator.
std::string scene_on_a_bench_with_an_open_place(const std::string& folder) {
  std::string bench = text_of(std::string(kScenes) + "/bench.toml");
  bench = with(bench, "[stage.axes.theta_r]", "high_deg = 85.0", "high_deg = 105.0");
  bench = with(bench, "[stage.carriage]", "trap_mm = 240.0", "trap_mm = 240.0\nopen_mm = 180.0");
  write_text(folder + "/bench.toml", bench + kAttenuator);
  const SceneOptions options{.seed = 20261122, .sample = "model = \"lambertian\"\nrho = 0.5\n", .more = kOptics};
  std::string scene = scene_text(options);
  scene = with(scene, "[scene]", std::string(kScenes) + "/bench.toml", folder + "/bench.toml");
  write_text(folder + "/scene.toml", scene);
  return folder + "/scene.toml";
}

class DirectBeam : public testing::Test {
 protected:
  DirectBeam() { bench_.bring_up_daemon(); }

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
  // The version that the job's scan made: it is computed aside, after the scan is done.
  std::string version_of(long scan) {
    std::string version;
    const auto is_there = [&] {
      const nlohmann::json list = bench_.get("calibrations");
      for (const auto& one : list.at("calibrations")) {
        if (one.at("scan") == scan) version = std::to_string(one.at("version").get<long>());
      }
      return !version.empty();
    };
    EXPECT_TRUE(eventually(is_there, std::chrono::seconds(20))) << bench_.log();
    return version;
  }
  // What the dry run says of absolute mode.
  nlohmann::json absolute_outlook() {
    const HttpAnswer answer = bench_.daemon().post("plans:check", nlohmann::json{{"plan", kCardPlan}}.dump());
    EXPECT_EQ(answer.status, 200) << answer.body;
    const nlohmann::json report = nlohmann::json::parse(answer.body);
    for (const auto& mode : report.at("modes")) {
      if (mode.at("mode") == "absolute") return mode;
    }
    return {};
  }

  TemporaryFolder scenes_;
  Bench bench_{scene_on_a_bench_with_an_open_place(scenes_.path()), 20261122};
};

TEST_F(DirectBeam, FoundByItsJobMakesAbsoluteModeAgreeWithTheTruth) {
  EXPECT_EQ(absolute_outlook().at("refused"), "no direct beam at this wavelength");
  const long job = run(kBeamPlan);
  const std::string version = version_of(job);
  (void)ask({"calibration", "use", version, "--reason", "looked at"});
  const std::string shown = ask({"calibration", "show", version});
  EXPECT_NE(shown.find("direct_beam_q_568nm"), std::string::npos) << shown;
  const nlohmann::json outlook = absolute_outlook();
  EXPECT_TRUE(outlook.at("refused").is_null()) << outlook;

  const long scan = run(kCardPlan);

  const Bench::MeasuredAndTrue tables = bench_.measured_and_true(scan);
  double chi2 = 0.0;
  double worst_of_u = 0.0;
  int values = 0;
  for (std::size_t k = 0; k < tables.measured.rows.size(); ++k) {
    const auto& row = tables.measured.rows[k];
    if (row.at("brdf_per_sr").empty()) continue;
    const double error = std::stod(row.at("brdf_per_sr")) - std::stod(tables.truth.rows[k].at("brdf_per_sr"));
    chi2 += std::pow(error / std::stod(row.at("u_per_sr")), 2);
    worst_of_u = std::max(worst_of_u, std::abs(error) / std::stod(row.at("expanded_u_per_sr")));
    EXPECT_LT(std::stod(row.at("u_per_sr")) / std::stod(row.at("brdf_per_sr")), 0.01);
    ++values;
  }
  std::printf("absolute: %d values, chi-square a value %.2f, worst error %.2f U; dry run U %.2f %%\n%s", values,
              chi2 / values, worst_of_u, 100.0 * outlook.at("median_relative_u").get<double>(), shown.c_str());
  EXPECT_EQ(values, 14) << "2 of 16 are one point at theta_r = 0";
  EXPECT_LE(worst_of_u, 1.0) << shown;
  EXPECT_EQ(bench_.scan(scan).at("calibrations"), version);
}

TEST_F(DirectBeam, HasNoBrdfOfItsOwnAndSaysSo) {
  (void)ask({"plan", "check", bench_.file("beam.toml", kBeamPlan)});
  const long job = run(kBeamPlan);
  (void)version_of(job);

  const CsvTable rows = bench_.exported(job);

  ASSERT_EQ(rows.rows.size(), 15U);
  for (const auto& row : rows.rows) EXPECT_EQ(row.at("status"), "refused");
}

}  // namespace
}  // namespace gonio::test
