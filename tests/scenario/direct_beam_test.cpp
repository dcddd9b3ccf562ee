// A sample measured without any standard: the job reads the direct beam through an attenuator, a person takes it into
// use, and absolute mode then says what is true. Attenuator, stop and arms are other than their papers say. And the
// same beam crossed both ways.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

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

constexpr const char* kSignaturePlan = R"([scan]
name = "signature"
sample = "nothing"
[calibration]
job = "signature"
wavelength_nm = [568]
theta_i_deg = 80
half_width_deg = 1.8
step_deg = 0.1
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

// Where an even beam of 3 mm, all of it within a stop of this radius at this distance, passes it by half: the beam's
// discs by strips across the way, each as high as the narrower of the two there.
double full_width_deg(double stop_mm, double distance_mm) {
  constexpr double kSpotMm = 3.0;
  constexpr int kStrips = 2000;
  const auto part_at = [&](double beside_mm) {
    double whole = 0.0;
    double within = 0.0;
    for (int k = 0; k < kStrips; ++k) {
      const double x = kSpotMm * (2.0 * (k + 0.5) / kStrips - 1.0);
      const double of_spot = std::sqrt(kSpotMm * kSpotMm - x * x);
      const double of_stop = std::sqrt(std::max(0.0, stop_mm * stop_mm - (x - beside_mm) * (x - beside_mm)));
      whole += of_spot;
      within += std::min(of_spot, of_stop);
    }
    return within / whole;
  };
  double inside = 0.0;
  double outside = stop_mm + kSpotMm;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (inside + outside);
    (part_at(middle) > 0.5 ? inside : outside) = middle;
  }
  constexpr double kDegree = 57.29577951308232;
  return 2.0 * kDegree * std::atan(inside / distance_mm);
}

// Widths, centres and the beam's radius, through the same wires; nothing else is computed with them.
TEST_F(DirectBeam, CrossedBothWaysTellsTheInstrumentsSignature) {
  const long job = run(kSignaturePlan);
  const std::string version = version_of(job);
  const nlohmann::json found = bench_.get("calibrations/" + version);

  std::map<std::string, std::pair<double, double>> values;
  for (const auto& one : found.at("values")) {
    values[one.at("name")] = {one.at("value").get<double>(), one.at("u").get<double>()};
  }
  std::printf("%s\n%s", found.at("note").get<std::string>().c_str(), ask({"calibration", "show", version}).c_str());
  ASSERT_EQ(values.size(), 5U) << found;
  const auto [radius, u_radius] = values.at("signature_beam_radius_568nm");
  EXPECT_NEAR(radius, 3.0, 2.0 * u_radius);
  EXPECT_LT(u_radius, 0.05);
  // The stop is other than stated, within its u: a part of the widths' truth, not of their u.
  const double stated = full_width_deg(10.0, 500.0);
  const double u_of_stop = std::hypot(full_width_deg(10.01, 500.0) - stated, full_width_deg(10.0, 500.25) - stated);
  for (const char* name : {"signature_width_plane_568nm", "signature_width_across_568nm"}) {
    const auto [width, u_width] = values.at(name);
    EXPECT_NEAR(width, stated, 2.0 * std::hypot(u_width, u_of_stop)) << name;
    EXPECT_LT(u_width, 0.02) << name;
  }
  // Where the arms count from: 0.02 deg each.
  EXPECT_LT(std::abs(values.at("signature_centre_plane_568nm").first), 4.0 * 0.0283);
  EXPECT_LT(std::abs(values.at("signature_centre_across_568nm").first), 4.0 * 0.0283);
  EXPECT_NE(found.at("note").get<std::string>().find("[beams] states 3 mm, the same within U"), std::string::npos);
  const Finished used = bench_.gonioctl({"calibration", "use", version, "--reason", "looked at"});
  EXPECT_NE(used.exit_code, 0);
  EXPECT_NE(used.errors.find("changes no scan"), std::string::npos) << used.errors;
}

}  // namespace
}  // namespace gonio::test
