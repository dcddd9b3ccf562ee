// A BRDF file stands on the stage: its own directions are measured, with exposures chosen for each reading, and
// compared with the file in units of U. A file that the test makes, and those of other laboratories where they are: in
// $GONIO_SHARED, else beside the source tree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <sstream>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"
#include "tests/scenario/store_copy.h"

namespace gonio::test {
namespace {

using testing::HasSubstr;

constexpr const char* kDirections = "12";  // and four views beside each

std::filesystem::path measured_files() {
  const char* named = std::getenv("GONIO_SHARED");
  return std::filesystem::path(named != nullptr ? named : GONIO_SOURCE_DIR "/../shared") / "data/measured";
}

// A gloss of 4 deg on a dark ground, as another program might write it: behind a byte order mark and a comment, lines
// with CR LF, out of order, one direction read twice.
std::string glossy_file() {
  constexpr double kRadian = std::numbers::pi / 180.0;
  std::ostringstream csv;
  csv << "\xEF\xBB\xBF# a glossy card\r\nf_per_sr,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\r\n";
  for (int theta_r = 80; theta_r >= 0; theta_r -= 4) {
    for (int phi = theta_r == 0 ? 350 : 0; phi < 360; phi += 10) {
      for (const int theta_i : {40, 20}) {
        const double x = std::sin(theta_r * kRadian) * std::cos(phi * kRadian) + std::sin(theta_i * kRadian);
        const double y = std::sin(theta_r * kRadian) * std::sin(phi * kRadian);
        const double off = std::hypot(x, y) / std::sin(4.0 * kRadian);
        csv << 0.02 + 4.0 * std::exp(-off * off) << "," << theta_i << ",0," << theta_r << "," << phi << "\r\n";
      }
    }
  }
  csv << "0.02,20,0,80,90\r\n";
  return csv.str();
}

// What scripts/lib/choose-points says of a file: KEY=VALUE words.
std::string value_of(const std::string& said, const std::string& key) {
  const std::size_t at = said.find(key + "=");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + key.size() + 1;
  return said.substr(begin, said.find_first_of(" \n", begin) - begin);
}

// "written: FILE" of the file that is a table.
std::string written_table(const std::string& said) {
  const std::string mark = "written: ";
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(mark) && line.ends_with(".csv")) return line.substr(mark.size());
  }
  return "";
}

struct Comparison {
  long chosen = 0;     ///< directions
  long exposures = 0;  ///< different ones, of the readings of the file
  CsvTable table;      ///< of `data compare`
  std::string said;
};

class MeasuredFile : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_ / name; }

  // As scripts/measure-file does it, step by step.
  Comparison measure(const std::string& file) {
    Comparison measured;
    const Finished converted =
        run_program({kGonioctl, "data", "convert", file, "--format", "csv+json", "-o", path("original")},
                    folder_.path(), kStepDeadline);
    EXPECT_EQ(converted.exit_code, 0) << converted.errors;
    const Finished chosen = run_program(
        {GONIO_SOURCE_DIR "/scripts/lib/choose-points", path("original.csv"), "0", kDirections, path("points.csv")},
        folder_.path(), kStepDeadline);
    EXPECT_EQ(chosen.exit_code, 0) << chosen.errors;
    measured.chosen = std::stol(value_of(chosen.output, "chosen"));
    Bench bench({.sample = "file = \"" + file + "\"\n",
                 .more = "[source]\nmonitor_noise = 0.002\nflicker = 0.002\npower = " +
                         value_of(chosen.output, "power") + "\n"});
    bench.bring_up_daemon();
    write_text(bench.folder() + "/points.csv", text_of(path("points.csv")));
    const std::string plan = bench.file("plan.toml", plan_text({.points = "points.csv", .target_snr = 300.0}));
    const Finished run = bench.gonioctl({"scan", "run", plan, "--watch"});
    EXPECT_EQ(run.exit_code, 0) << run.output << run.errors << bench.log();
    const Finished compared = bench.gonioctl({"data", "compare", "1", file, "-o", path("comparison")});
    EXPECT_EQ(compared.exit_code, 0) << compared.output << compared.errors;
    measured.said = compared.output;
    measured.table = parse_csv(text_of(written_table(compared.errors)));
    EXPECT_EQ(bench.end_daemon(), 0);
    measured.exposures = StoreCopy(bench.files().store, folder_.path())
                             .count(
                                 "(SELECT DISTINCT exposure_ns FROM reading JOIN attempt USING (attempt_id) "
                                 "WHERE target = 'sample')");
    return measured;
  }

  TemporaryFolder folder_;
};

// The stage held the very table: what it may miss between the file's readings is no error of the measurement.
double off_in_u(const std::map<std::string, std::string>& row) {
  const double u = std::stod(row.at("u_per_sr"));
  const double of_table = std::stod(row.at("u_interpolation_per_sr"));
  return std::abs(std::stod(row.at("difference_per_sr"))) / (2.0 * std::sqrt((u - of_table) * (u + of_table)));
}

// Readings of one scan share the errors of certificate and arms, so that the share of intervals that hold varies from
// scan to scan far more than by chance of one reading: 95 % is what campaigns find. Far off, or seldom within U, is a
// wrong direction, scale, dark or exposure.
void expect_the_file(const Comparison& measured) {
  EXPECT_THAT(measured.said, HasSubstr("share within U"));
  EXPECT_GE(measured.exposures, 4) << "peak and ground cannot use the same";
  EXPECT_GE(static_cast<long>(measured.table.rows.size()), 3 * measured.chosen)
      << "views beside a reading of the file's border are none of the file\n"
      << measured.said;
  long within = 0;
  for (const auto& row : measured.table.rows) {
    const double off = off_in_u(row);
    within += off <= 1.0 ? 1 : 0;
    EXPECT_LT(off, 5.0) << row.at("theta_i_deg") << " " << row.at("theta_r_deg") << " " << row.at("phi_r_deg") << ": "
                        << row.at("first_per_sr") << " against " << row.at("second_per_sr");
  }
  EXPECT_GE(within, static_cast<long>(measured.table.rows.size()) * 8 / 10) << measured.said;
  std::cout << within << " of " << measured.table.rows.size() << " within U\n" << measured.said;
}

TEST_F(MeasuredFile, ThatTheTestMadeIsFoundAgain) {
  write_text(path("glossy.csv"), glossy_file());

  expect_the_file(measure(path("glossy.csv")));
}

class FileOfOthers : public MeasuredFile, public testing::WithParamInterface<const char*> {};

TEST_P(FileOfOthers, IsFoundAgain) {
  const std::filesystem::path file = measured_files() / GetParam();
  if (!std::filesystem::exists(file)) {
    std::cout << "no " << file << ": nothing checked\n";
    return;
  }

  expect_the_file(measure(std::filesystem::canonical(file).string()));
}

INSTANTIATE_TEST_SUITE_P(Files, FileOfOthers, testing::Values("retro-3m-yellow.alta", "anoblack-ec1.zemax.bsdf"),
                         [](const auto& of) { return std::string(of.param).substr(0, 5); });

}  // namespace
}  // namespace gonio::test
