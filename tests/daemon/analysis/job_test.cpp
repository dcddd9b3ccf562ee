// The worker program's jobs, in process, on stores and files that the tests make.
#include "daemon/analysis/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>

#include "daemon/analysis/input_file.h"
#include "daemon/analysis/stored_scan.h"
#include "tests/daemon/analysis/stored_scans.h"
#include "tests/support/process.h"

namespace gonio::analysis {
namespace {

using formats::BrdfPoint;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kRadian = std::numbers::pi / 180.0;

api::Plan grid() {
  return daemon::test::bench_plan({0, 30, 60}, {0, 15, 30, 45, 60, 75}, {0, 30, 60, 90, 120, 150, 180});
}

class Jobs : public testing::Test {
 protected:
  Result<api::AnalysisReport> run(const std::string& store, const api::AnalysisRequest& request) {
    Progress progress(Progress::Form::Lines, told_, told_, false);
    return run_job({.request = request,
                    .store_file = store,
                    .input_file = {},
                    .folder = folder_.path(),
                    .name = "scan-" + std::to_string(request.scan)},
                   progress);
  }
  Result<api::AnalysisReport> run_on_file(const std::string& file, const std::string& kind,
                                          const std::string& format = {}) {
    Progress progress(Progress::Form::Lines, told_, told_, false);
    return run_job({.request = {.kind = kind, .format = format},
                    .store_file = {},
                    .input_file = file,
                    .folder = folder_.path(),
                    .name = "made"},
                   progress);
  }
  std::string file(const std::string& name, const std::string& text) {
    gonio::test::write_text(folder_ / name, text);
    return folder_ / name;
  }

  gonio::test::TemporaryFolder folder_;
  std::ostringstream told_;
};

// Between the bright reading's directions and (30, 0), (30, 0), as vectors: no convention of ours comes in.
double off_degrees(double theta_deg, double phi_deg) {
  const double s = std::sin(theta_deg * kRadian);
  const double along = s * std::cos(phi_deg * kRadian) * std::sin(30.0 * kRadian) +
                       std::cos(theta_deg * kRadian) * std::cos(30.0 * kRadian);
  return std::acos(std::min(1.0, along)) / kRadian;
}

struct Readable {
  const char* format;
  double within_deg;  ///< as far as the format's own directions may lie
};
class BrightReading : public Jobs, public testing::WithParamInterface<Readable> {};

TEST_P(BrightReading, LandsWhereItWas) {
  const test::StoredValues store(grid(), test::bright_at_retro);

  const auto done = run(store.file(), {.kind = "export", .scan = store.id(), .format = GetParam().format});

  ASSERT_TRUE(done) << describe(done.error());
  const Result<InputFile> read = read_input_file(folder_ / done->files.at(0).name);
  ASSERT_TRUE(read) << describe(read.error());
  const BrdfPoint& bright = *std::ranges::max_element(read->brdf.points, {}, &BrdfPoint::f_per_sr);
  EXPECT_NEAR(bright.f_per_sr, 1.0, 0.1) << "a node beside the reading has less of its peak";
  // A format that knows no phi_i counts phi_r from it.
  EXPECT_LT(off_degrees(bright.theta_i_deg, 0.0), GetParam().within_deg);
  EXPECT_LT(off_degrees(bright.theta_r_deg, bright.phi_r_deg - bright.phi_i_deg), GetParam().within_deg);
}

INSTANTIATE_TEST_SUITE_P(Formats, BrightReading,
                         testing::Values(Readable{"csv+json", 1e-5}, Readable{"bird", 1e-5}, Readable{"astm", 1e-5},
                                         Readable{"nexus", 1e-5}, Readable{"ssdd", 1e-5}, Readable{"zemax", 3.0},
                                         Readable{"merl", 1.5}, Readable{"rgl", 1.0}),
                         [](const auto& of) {
                           std::string name = of.param.format;
                           std::erase(name, '+');
                           return name;
                         });

// One file an incidence: lines of theta, phi, value.
TEST_F(Jobs, PabTextHasTheBrightReadingWhereItWas) {
  const test::StoredValues store(grid(), test::bright_at_retro);

  const auto done = run(store.file(), {.kind = "export", .scan = store.id(), .format = "pab"});

  ASSERT_TRUE(done) << describe(done.error());
  std::istringstream lines(gonio::test::text_of(folder_ / "scan-1-30-0.dat"));
  double theta = 0.0;
  double phi = 0.0;
  double f = 0.0;
  std::string line;
  while (std::getline(lines, line)) {
    if (std::sscanf(line.c_str(), "%lf %lf %lf", &theta, &phi, &f) == 3 && f > 0.5) break;
  }
  EXPECT_NEAR(f, 1.0, 1e-9);
  EXPECT_LT(off_degrees(theta, phi), 1e-5);
}

TEST_F(Jobs, KlemsFileHasMoreThereThanAnywhereElse) {
  const test::StoredValues store(grid(), test::bright_at_retro);

  const auto done = run(store.file(), {.kind = "export", .scan = store.id(), .format = "klems"});

  ASSERT_TRUE(done) << describe(done.error());
  std::string xml = gonio::test::text_of(folder_ / done->files.at(0).name);
  const std::size_t begin = xml.find("<ScatteringData>") + 16;
  xml = xml.substr(begin, xml.find("</ScatteringData>") - begin);
  std::ranges::replace(xml, ',', ' ');
  std::istringstream in(xml);
  std::vector<double> values;
  for (double value = 0.0; in >> value;) values.push_back(value);
  ASSERT_EQ(values.size(), 145U * 145U);
  // Rings of 1, 8, 16, 20 patches: theta 25 to 35 deg is the fourth, its patch at phi = 0 is number 25, at 180 deg
  // number 35: which is what the basis of incidence calls the direction phi = 0.
  const std::size_t incident = 35;
  std::size_t brightest = 0;
  for (std::size_t r = 0; r < 145; ++r) {
    if (values[r * 145 + incident] > values[brightest * 145 + incident]) brightest = r;
  }
  EXPECT_EQ(brightest, 25U);
}

TEST_F(Jobs, CarriesUAndFlagsWhereverAFormatHoldsThem) {
  const test::StoredValues store(grid(), test::bright_at_retro, 0b101);
  for (const char* format : {"csv+json", "bird", "nexus"}) {
    SCOPED_TRACE(format);
    const auto done = run(store.file(), {.kind = "export", .scan = store.id(), .format = format});
    ASSERT_TRUE(done) << describe(done.error());
    const Result<InputFile> read = read_input_file(folder_ / done->files.at(0).name);
    ASSERT_TRUE(read) << describe(read.error());

    const BrdfPoint& point = read->brdf.points.at(0);

    EXPECT_NEAR(point.U_per_sr, 2.0 * std::hypot(0.001, 0.01 * point.f_per_sr), 1e-5);
    EXPECT_NEAR(point.u_shared_per_sr, 0.01 * point.f_per_sr, 1e-12);
    ASSERT_EQ(point.flags, 0b101U);
    EXPECT_EQ(read->brdf.flag_names.at(0), "near-zero");
    EXPECT_EQ(read->brdf.flag_names.at(2), "few-neighbours");
    EXPECT_THAT(done->losses, IsEmpty());
    EXPECT_THAT(done->notes, Contains(HasSubstr("every value is flagged: near-zero, few-neighbours")));
  }
  const auto astm = run(store.file(), {.kind = "export", .scan = store.id(), .format = "astm"});
  std::vector<std::string> lost;
  for (const api::AnalysisLoss& loss : astm->losses) lost.push_back(loss.kind);
  EXPECT_THAT(lost, Contains("uncertainty"));
  EXPECT_THAT(lost, Contains("flags"));
}

TEST_F(Jobs, NegativeValuesStayWhereAFormatHoldsThemAndAreCountedElsewhere) {
  const test::StoredValues store(grid(), [](const Geometry& g) { return in_degrees(g.theta_r) > 50.0 ? -0.01 : 0.02; });

  const auto csv = run(store.file(), {.kind = "export", .scan = store.id(), .format = "csv+json"});
  const auto merl = run(store.file(), {.kind = "export", .scan = store.id(), .format = "merl"});

  const Result<InputFile> read = read_input_file(folder_ / csv->files.at(0).name);
  EXPECT_EQ(std::ranges::min_element(read->brdf.points, {}, &BrdfPoint::f_per_sr)->f_per_sr, -0.01);
  EXPECT_NE(std::ranges::find(merl->losses, "sign", &api::AnalysisLoss::kind), merl->losses.end());
}

TEST_F(Jobs, AScanWithoutAValueSaysWhatItHas) {
  const test::StoredValues store(daemon::test::bench_plan({30}, {0, 30}, {90}), test::bright_at_retro);
  const auto nothing = run(store.file(), {.kind = "export", .scan = 77, .format = "bird"});
  EXPECT_EQ(nothing.error().code, ErrorCode::NotFound);

  StoredScan empty;
  empty.info.id = 5;
  empty.info.counts = {.points = 12, .blocked = 2, .accepted = 3};
  const auto values = measured_brdf(empty);

  ASSERT_FALSE(values);
  EXPECT_THAT(describe(values.error()),
              HasSubstr("no value: 12 points, 3 items accepted, 0 skipped, 2 points blocked"));
}

TEST_F(Jobs, OneIncidenceIsExportedWithANote) {
  const test::StoredValues store(daemon::test::bench_plan({30}, {0, 15, 30, 45}, {0, 60, 120, 180}),
                                 test::bright_at_retro);

  const auto done = run(store.file(), {.kind = "export", .scan = store.id(), .format = "zemax"});

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_THAT(done->notes, Contains(HasSubstr("one theta_i only")));
}

TEST_F(Jobs, AForeignFileIsConvertedAndDescribed) {
  const test::StoredValues store(grid(), [](const Geometry&) { return 0.1; });
  const auto astm = run(store.file(), {.kind = "export", .scan = store.id(), .format = "astm"});
  const std::string path = folder_ / astm->files.at(0).name;

  const auto made = run_on_file(path, "export", "bird");
  const auto described = run_on_file(path, "describe");

  ASSERT_TRUE(made) << describe(made.error());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "made.brdf"));
  EXPECT_THAT(made->notes, Contains("read as astm"));
  ASSERT_TRUE(described) << describe(described.error());
  const auto rho =
      std::ranges::find_if(described->facts, [](const auto& fact) { return fact.name.starts_with("rho_dh(30"); });
  ASSERT_NE(rho, described->facts.end());
  EXPECT_NEAR(rho->value, 0.1 * std::numbers::pi, 1e-3) << "pi f of a Lambertian, the cap beyond 75 deg held";
}

TEST_F(Jobs, ModelsThatDoNotFitAreSaidToAndCountForLessBeyondTheReadings) {
  const test::StoredValues matte(grid(), [](const Geometry&) { return 0.1; });
  const test::StoredValues woven(grid(), [](const Geometry& g) { return 0.1 + 0.05 * std::cos(4.0 * g.phi_r.si()); });
  const auto u_of_albedo = [](const api::AnalysisReport& told) {
    const auto found =
        std::ranges::find_if(told.facts, [](const auto& fact) { return fact.name.starts_with("bond_albedo"); });
    return found == told.facts.end() ? 0.0 : found->expanded_u.value_or(0.0) / found->value;
  };

  const auto fit = run(woven.file(), {.kind = "fit", .scan = woven.id()});
  const auto quantities = run(woven.file(), {.kind = "quantities", .scan = woven.id()});
  const auto simple_fit = run(matte.file(), {.kind = "fit", .scan = matte.id()});
  const auto simple = run(matte.file(), {.kind = "quantities", .scan = matte.id()});

  ASSERT_TRUE(fit) << describe(fit.error());
  ASSERT_TRUE(quantities) << describe(quantities.error());
  ASSERT_TRUE(simple_fit && simple);
  EXPECT_THAT(fit->notes, Contains(HasSubstr("none of them fits")));
  EXPECT_THAT(simple_fit->notes, Not(Contains(HasSubstr("none of them fits"))));
  EXPECT_THAT(quantities->notes, Contains(HasSubstr("none of the models that were tried fits")));
  EXPECT_THAT(simple->notes, Not(Contains(HasSubstr("none of the models"))));
  EXPECT_GT(u_of_albedo(*quantities), 2.0 * u_of_albedo(*simple));
}

TEST_F(Jobs, BadFilesHaveTheirWordAndLeaveNothing) {
  const std::string header = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr\n";
  const auto word_for = [&](const std::string& text) {
    const auto done = run_on_file(file("bad.csv", text), "export", "bird");
    EXPECT_FALSE(done);
    return done ? std::string() : describe(done.error());
  };

  EXPECT_THAT(word_for("GIF89a"), HasSubstr("none of the formats that are known"));
  EXPECT_THAT(word_for(""), HasSubstr("an empty file"));
  EXPECT_THAT(word_for(header + "0,0,10,0,0.1\n0,0,20,0,0."), HasSubstr("bad.csv:3"));
  EXPECT_THAT(word_for(header + "0,0,10,0,nan\n"), HasSubstr("bad.csv:2"));
  EXPECT_THAT(word_for(header), HasSubstr("no points"));
  EXPECT_EQ(run_on_file(folder_ / "none.csv", "export", "bird").error().code, ErrorCode::FileUnreadable);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "made.brdf"));
}

TEST_F(Jobs, WhatCannotBeWrittenIsLeftAsItWas) {
  const test::StoredValues store(grid(), test::bright_at_retro);
  std::filesystem::create_directory(folder_ / "scan-1.brdf");

  const auto done = run(store.file(), {.kind = "export", .scan = store.id(), .format = "bird"});

  ASSERT_FALSE(done);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr("part")));
  }
}

TEST_F(Jobs, TellsEachStepOnALineOfItsOwn) {
  const test::StoredValues store(grid(), test::bright_at_retro);

  ASSERT_TRUE(run(store.file(), {.kind = "export", .scan = store.id(), .format = "astm"}));

  EXPECT_THAT(told_.str(), HasSubstr("\"doing\":\"writing astm\""));
  EXPECT_EQ(std::ranges::count(told_.str(), '\n'), 3);
}

}  // namespace
}  // namespace gonio::analysis
