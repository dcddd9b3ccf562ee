// A camera whose pixels differ and of which some are full at a tenth of the scale: a job finds them, its files are put
// beside instrument.toml, and a dark sample, which was too bright beside the standard, agrees with the truth. What the
// pixels are, and what that does to a mean, is the simulator's own pattern and arithmetic done here.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/devices/pixel_pattern.h"
#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kSeed = 20261123;
constexpr int kSide = 64;
constexpr double kMiddle = 31.5;  // px
constexpr double kRadius = 12.0;
constexpr double kEarlyFull_dn = 409.0;  // floor(4095 / 10)
constexpr double kFlatSigma = 0.02;
constexpr double kBadFraction = 0.05;

// The bench's, with a pattern. White at 45 deg: 2800 DN in 16 ms; wall time is 40 times shorter.
constexpr const char* kDetector = R"([detector]
serial = "SIM-0001"
width_px = 64
height_px = 64
electrons_per_s = 700000.0
electrons_per_dn = 4.0
read_noise_dn = 1.5
dark_dn_per_s = 8.0
offset_dn = 64.0
u_linearity = 0.001
spot_radius_px = 24.0
aperture_radius_px = 12.0
shortest_exposure_s = 0.001
longest_exposure_s = 0.512
frames_at_most = 64
flat_sigma = 0.02
bad_fraction = 0.05
)";

constexpr const char* kCard = R"([scan]
name = "card"
sample = "black card"
[geometry]
theta_i_deg = [0]
theta_r_deg = [45]
phi_r_deg = [90]
wavelength_nm = [568]
repeats = 6
[reading]
target_snr = 1000
max_time_s = 0.0256
exposure_s = [4e-4]
[reference]
standard = "SRT-99-020"
block_s = 20
[visits]
dark_s = 10
)";

// The darks alone count: one lit reading is enough.
constexpr const char* kDarkMap = R"([scan]
name = "darks"
sample = "black card"
[calibration]
job = "dark-map"
frames = 16
[geometry]
theta_i_deg = [0]
theta_r_deg = [45]
phi_r_deg = [90]
wavelength_nm = [568]
[reading]
target_snr = 100
max_time_s = 0.0128
[reference]
standard = "SRT-99-020"
block_s = 20
[visits]
dark_s = 10
)";

// Frames as many as a reading may have: its signal-to-noise is beyond reach.
constexpr const char* kFlatField = R"([scan]
name = "pixels"
sample = "black card"
[calibration]
job = "flat-field"
frames = 32
[geometry]
theta_i_deg = [0]
theta_r_deg = [45]
phi_r_deg = [90]
wavelength_nm = [568]
repeats = 4
[reading]
target_snr = 1e6
max_time_s = 0.0256
exposure_s = [4e-4]
[reference]
standard = "SRT-99-020"
block_s = 20
[visits]
dark_s = 10
)";

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}
template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The pixels inside the aperture, as the simulator made them.
struct Truth {
  Truth() {
    const sim::DetectorSpec spec{.flat_sigma = kFlatSigma, .bad_fraction = kBadFraction};
    const sim::PixelPattern pattern(spec, kSeed);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        if (std::hypot(x - kMiddle, y - kMiddle) > kRadius) continue;
        ++pixels;
        all += pattern.response(x, y);
        if (pattern.is_bad(x, y)) {
          ++bad;
          continue;
        }
        good += pattern.response(x, y);
        good_at.push_back({kSide * y + x, pattern.response(x, y)});
      }
    }
  }
  // Bad pixels show the standard's light only up to their own end, and all of the dark sample's. By how much that makes
  // the sample too bright, with the standard's mean reading above the dark and the dark level known.
  [[nodiscard]] double bias(double reference_net_dn, double dark_dn) const {
    const double light = (pixels * reference_net_dn - bad * (kEarlyFull_dn - dark_dn)) / good;
    return light * (all / pixels) / reference_net_dn;
  }
  double pixels = 0.0;
  double bad = 0.0;
  double all = 0.0;   ///< sum of responses
  double good = 0.0;  ///< of the good ones
  std::vector<std::pair<int, double>> good_at;
};

class DetectorMapsScenario : public testing::Test {
 protected:
  long run(const std::string& plan) {
    const long scan = bench_.submit(plan);
    EXPECT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted", "holding"}), "done")
        << bench_.holds_of(scan) << bench_.log();
    return scan;
  }
  // Measured over true, the mean over the repeats.
  double ratio_of(long scan) {
    const Bench::MeasuredAndTrue tables = bench_.measured_and_true(scan);
    double sum = 0.0;
    for (std::size_t k = 0; k < tables.measured.rows.size(); ++k) {
      sum += std::stod(tables.measured.rows[k].at("brdf_per_sr")) / std::stod(tables.truth.rows[k].at("brdf_per_sr"));
    }
    return sum / static_cast<double>(tables.measured.rows.size());
  }
  // Means of the stored readings: of the standard, and of the dark at the same exposure.
  std::pair<double, double> levels_of(long scan) {
    SQLite::Database store(bench_.files().store, SQLite::OPEN_READONLY);
    const std::string of_scan = " scan_id = " + std::to_string(scan);
    const double lit = store
                           .execAndGet(
                               "SELECT avg(mean_dn) FROM reading JOIN attempt USING (attempt_id) WHERE used AND "
                               "outcome = 'accepted' AND target = 'reference' AND" +
                               of_scan)
                           .getDouble();
    const double dark = store
                            .execAndGet(
                                "SELECT avg(mean_dn) FROM reading JOIN visit USING (visit_id) WHERE exposure_ns "
                                "= 400000 AND" +
                                of_scan)
                            .getDouble();
    return {lit, dark};
  }
  // Killed once in its midst.
  nlohmann::json found_by_a_job_that_was_killed() {
    const long scan = bench_.submit(kFlatField);
    EventReader client(bench_.daemon().port(), 0);
    constexpr long kOfTheCard = 12;
    const auto has_some = [](const auto& events) { return count_of(events, "item-accepted") >= kOfTheCard + 3; };
    EXPECT_TRUE(client.wait_for(has_some, kStepDeadline)) << bench_.log();
    bench_.bring_up_daemon();
    EXPECT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted", "holding"}), "done") << bench_.log();
    return found_by(scan);
  }
  nlohmann::json found_by(long scan) {
    nlohmann::json found;
    const auto is_there = [&] {
      const nlohmann::json list = bench_.get("calibrations");
      for (const auto& one : list.at("calibrations")) {
        if (one.at("scan") == scan) found = one;
      }
      return !found.is_null();
    };
    EXPECT_TRUE(eventually(is_there, kStepDeadline)) << bench_.log();
    return found;
  }
  static double value_of(const nlohmann::json& version, const std::string& name) {
    for (const auto& one : version.at("values")) {
      if (one.at("name") == name) return one.at("value").get<double>();
    }
    ADD_FAILURE() << name << " in " << version;
    return -1.0;
  }

  Truth truth_;
  Bench bench_{SceneOptions{.time_scale = 40.0,
                            .draw_errors = false,
                            .seed = kSeed,
                            .sample = "model = \"lambertian\"\nrho = 0.08\n",
                            .more = kDetector}};
};

TEST_F(DetectorMapsScenario, FoundByAJobTheyTakeOutOfAScanWhatItsPixelsPutIn) {
  bench_.bring_up_daemon();
  const long before = run(kCard);
  const auto [lit, dark] = levels_of(before);
  const double expected = truth_.bias(lit - dark, dark);
  ASSERT_GT(expected, 1.03) << "the test sees what it is about";
  EXPECT_NEAR(ratio_of(before), expected, 0.004);

  const nlohmann::json version = found_by_a_job_that_was_killed();
  ASSERT_FALSE(version.is_null());
  EXPECT_EQ(value_of(version, "bad_dead"), truth_.bad) << version;
  EXPECT_EQ(value_of(version, "bad_pixels"), truth_.bad) << version;
  const std::string number = std::to_string(version.at("version").get<long>());
  const Finished used = bench_.gonioctl({"calibration", "use", number});
  EXPECT_NE(used.exit_code, 0);
  EXPECT_THAT(used.errors, HasSubstr("[detector.maps]"));
  const Finished written = bench_.gonioctl({"calibration", "maps", number, "--to", bench_.folder()});
  ASSERT_EQ(written.exit_code, 0) << written.errors << bench_.log();

  const std::string flat = bytes_of(bench_.folder() + "/flat-" + number + ".map");
  ASSERT_EQ(flat.size(), 64U + 4U * kSide * kSide);
  const auto u = number_at<double>(flat, 24);
  const double mean = truth_.good / static_cast<double>(truth_.good_at.size());
  double chi_square = 0.0;
  for (const auto& [pixel, response] : truth_.good_at) {
    const auto value = number_at<float>(flat, 64U + 4U * static_cast<std::size_t>(pixel));
    chi_square += std::pow((static_cast<double>(value) - response / mean) / u, 2);
  }
  chi_square /= static_cast<double>(truth_.good_at.size());
  EXPECT_NEAR(chi_square, 1.0, 0.3) << "430 pixels: four standard deviations of it are 0.27";

  EXPECT_EQ(bench_.end_daemon(), 0);
  bench_.use_instrument(bench_.file("mapped.toml", bytes_of(bench_.files().instrument) + "\n" + written.output));
  bench_.bring_up_daemon();
  const double after = ratio_of(run(kCard));
  EXPECT_NEAR(after, 1.0, 0.004);
  std::printf(
      "measured / true: %.4f without maps (%.4f expected of %.0f bad pixels in %.0f), %.4f with them; flat's "
      "chi-square %.2f\n",
      ratio_of(before), expected, truth_.bad, truth_.pixels, after, chi_square);
}

// Offset 64 DN and 8 DN/s of scene time, 40 times as much of wall time; each pixel the same, and 1.5 DN of noise.
TEST_F(DetectorMapsScenario, ADarkMapIsThatOfTheCameraAndComesAgainFromItsTape) {
  bench_.record_to(bench_.folder() + "/night.tape");
  bench_.bring_up_daemon();
  const long scan = run(kDarkMap);
  const nlohmann::json version = found_by(scan);
  ASSERT_FALSE(version.is_null());
  const std::string number = std::to_string(version.at("version").get<long>());
  const Finished written = bench_.gonioctl({"calibration", "maps", number, "--to", bench_.folder()});
  ASSERT_EQ(written.exit_code, 0) << written.errors << bench_.log();
  EXPECT_THAT(written.output, Not(HasSubstr("flat")));
  EXPECT_EQ(bench_.end_daemon(), 0);

  const std::string dark = bytes_of(bench_.folder() + "/dark-" + number + ".map");
  ASSERT_EQ(dark.size(), 64U + 2U * 4U * kSide * kSide) << "offset and rate";
  double chi_square = 0.0;
  double rate_chi_square = 0.0;
  for (const auto& [pixel, response] : truth_.good_at) {
    const std::size_t at = 64U + 4U * static_cast<std::size_t>(pixel);
    const double offset = static_cast<double>(number_at<float>(dark, at));
    const double rate = static_cast<double>(number_at<float>(dark, at + 4U * kSide * kSide));
    chi_square += std::pow((offset - 64.0) / number_at<double>(dark, 24), 2);
    rate_chi_square += std::pow((rate - 320.0) / number_at<double>(dark, 32), 2);
  }
  const auto n = static_cast<double>(truth_.good_at.size());
  EXPECT_NEAR(chi_square / n, 1.0, 0.3) << "430 pixels: four standard deviations of it are 0.27";
  EXPECT_NEAR(rate_chi_square / n, 1.0, 0.3);
  EXPECT_EQ(value_of(version, "bad_pixels"), 0.0) << "in the dark they are as good as the others";

  const Finished again = run_program({kGonioctl, "replay", bench_.folder() + "/night.tape", "--store",
                                      bench_.folder() + "/again.sqlite", "--against", bench_.files().store},
                                     bench_.folder(), kScanDeadline);
  EXPECT_EQ(again.exit_code, 0) << again.output << again.errors;
  SQLite::Database store(bench_.folder() + "/again.sqlite", SQLite::OPEN_READONLY);
  EXPECT_GT(store.execAndGet("SELECT count(*) FROM pixel_sum").getInt(), 0);
}

}  // namespace
}  // namespace gonio::test
