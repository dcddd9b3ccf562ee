// Scans beside scans, files and models; symmetries; repeatability: the jobs, on stores and files that the tests make.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "daemon/analysis/job.h"
#include "daemon/analysis/model_text.h"
#include "reflectance/formats/csv_file.h"
#include "reflectance/formats/merl_file.h"
#include "reflectance/formats/write_export.h"
#include "reflectance/surface/lambertian.h"
#include "tests/daemon/analysis/stored_scans.h"
#include "tests/support/process.h"

namespace gonio::analysis {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Exchanged directions, mirrored ones, and turned ones are among them.
api::Plan square_grid() {
  return daemon::test::bench_plan({0, 30, 60}, {0, 30, 60}, {0, 60, 120, 180, 240, 300});
}

class Comparisons : public testing::Test {
 protected:
  Result<api::AnalysisReport> run(const std::string& store, api::AnalysisRequest request,
                                  const std::string& other_file = {}) {
    Progress progress(Progress::Form::Lines, told_, told_, false);
    request.deadline_s = 60.0;
    return run_job({.request = request,
                    .store_file = store,
                    .input_file = {},
                    .other_file = other_file,
                    .folder = folder_.path(),
                    .name = "scan-" + std::to_string(request.scan)},
                   progress);
  }
  // The fact of this name, which there must be.
  static double fact(const api::AnalysisReport& report, const std::string& name) {
    const auto at = std::ranges::find(report.facts, name, &api::AnalysisFact::name);
    EXPECT_NE(at, report.facts.end()) << name;
    return at == report.facts.end() ? NAN : at->value;
  }
  std::vector<std::string> lines_of(const std::string& name) {
    std::istringstream in(gonio::test::text_of(folder_ / name));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }

  gonio::test::TemporaryFolder folder_;
  std::ostringstream told_;
};

const auto kTenth = [](const Geometry&) { return 0.1; };

// The stored values have u_random 0.001 and a certificate of 1 % that both share.
TEST_F(Comparisons, TwoScansDifferInUnitsOfWhatDoesNotCancel) {
  test::StoredValues store(square_grid(), kTenth);
  const auto other =
      store.add(square_grid(), [](const Geometry& g) { return in_degrees(g.theta_i) > 45.0 ? 0.104 : 0.1; });

  const auto done = run(store.file(), {.kind = "compare", .scan = store.id(), .other_scan = other});

  ASSERT_TRUE(done) << describe(done.error());
  // -0.004 over hypot(0.001, 0.001, 0.01 * 0.004).
  EXPECT_NEAR(fact(*done, "worst z"), -0.004 / std::hypot(0.001, 0.001, 0.00004), 1e-6);
  EXPECT_LT(fact(*done, "p value"), 1e-3);
  EXPECT_GT(fact(*done, "share within U"), 50.0);
  EXPECT_EQ(fact(*done, "without a partner"), 0.0);
  EXPECT_THAT(done->notes, Contains(HasSubstr("both share \"certificate\": 1 % of the values")));
  const auto lines = lines_of("scan-1-against-2.csv");
  EXPECT_EQ(lines.size(), static_cast<std::size_t>(fact(*done, "points compared")) + 1);
  EXPECT_THAT(lines.front(), HasSubstr("first_per_sr,second_per_sr,difference_per_sr,u_per_sr,z,difference_in_U"));
}

TEST_F(Comparisons, AModelByItsNumbersIsTakenForExact) {
  const test::StoredValues store(square_grid(), [](const Geometry&) { return 0.4 / M_PI; });

  const auto right = run(store.file(), {.kind = "compare", .scan = store.id(), .other_model = "lambertian rho=0.4"});
  const auto wrong = run(store.file(), {.kind = "compare", .scan = store.id(), .other_model = "lambertian rho=0.5"});

  ASSERT_TRUE(right) << describe(right.error());
  EXPECT_NEAR(fact(*right, "worst z"), 0.0, 1e-9);
  EXPECT_EQ(fact(*right, "share within U"), 100.0);
  EXPECT_NEAR(fact(*wrong, "mean ratio"), 0.8, 1e-12);
  // The certificate's 1 % counts against a model: 20 % are no more than 20 of its u.
  EXPECT_NEAR(fact(*wrong, "worst z"), -0.1 / M_PI / std::hypot(0.001, 0.004 / M_PI), 1e-6);
}

TEST_F(Comparisons, AModelWithoutNumbersIsFittedFirst) {
  const test::StoredValues store(square_grid(), [](const Geometry&) { return 0.4 / M_PI; });

  const auto done = run(store.file(), {.kind = "compare", .scan = store.id(), .other_model = "lambertian"});

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_NEAR(fact(*done, "mean ratio"), 1.0, 1e-6);
  EXPECT_THAT(done->notes, Contains(HasSubstr("fitted to this scan: lambertian rho=0.4")));
}

TEST_F(Comparisons, AFileIsReadBetweenItsReadingsAndItsUncertaintiesCount) {
  const test::StoredValues store(daemon::test::bench_plan({30}, {10, 20, 40, 70}, {90, 120, 150}), kTenth);
  std::string csv = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr,U_per_sr,k,u_shared_per_sr\n";
  for (const int theta_r : {0, 15, 30, 45, 60}) {
    for (int phi = 0; phi <= 180; phi += 15)
      csv += "30,0," + std::to_string(theta_r) + "," + std::to_string(phi) + ",0.11,0.006,2,0.003\n";
  }
  gonio::test::write_text(folder_ / "theirs.csv", csv);

  const auto done = run(store.file(), {.kind = "compare", .scan = store.id()}, folder_ / "theirs.csv");

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(fact(*done, "points compared"), 9.0);
  EXPECT_EQ(fact(*done, "without a partner"), 3.0) << "theta_r of 70 deg lies beyond the file's readings";
  // Their shared 0.003 is the same at all of their readings, and so between them; ours are 0.001 and 1 % of 0.1.
  EXPECT_NEAR(fact(*done, "worst z"), -0.01 / std::hypot(0.001, 0.001, 0.003), 1e-3);
  EXPECT_THAT(done->notes, Contains(HasSubstr("the other: read as csv")));
  EXPECT_THAT(done->notes, Contains(HasSubstr("the other: no JSON beside the CSV: by its directions the sample is "
                                              "taken for isotropic, left and right alike")));
  EXPECT_THAT(done->notes, Contains(HasSubstr("not compared: 0 points beyond the file's incidences or between two "
                                              "farther apart than 60 deg, 3 beyond its views, 0 in cells wider")));
  EXPECT_EQ(lines_of("scan-1-against-theirs.csv").size(), 10U);
}

TEST_F(Comparisons, ACoarseFileIsComparedWithTheDoubtBetweenItsReadings) {
  const test::StoredValues store(daemon::test::bench_plan({40}, {20, 50}, {90, 105}), kTenth);
  std::string csv = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,f_per_sr\n";
  for (const int theta_i : {10, 60}) {
    for (const int theta_r : {0, 40, 80}) {
      for (int phi = 0; phi <= 180; phi += 45)
        csv += fmt::format("{},0,{},{},{}\n", theta_i, theta_r, phi, 0.1 + 1e-3 * theta_r + 1e-3 * (theta_i - 40));
    }
  }
  gonio::test::write_text(folder_ / "coarse.csv", csv);

  const auto done = run(store.file(), {.kind = "compare", .scan = store.id()}, folder_ / "coarse.csv");

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_EQ(fact(*done, "points compared"), 4.0) << "cells of 40 by 45 deg, incidences 50 deg apart";
  EXPECT_GT(fact(*done, "chi-square, exact table"), 2.0 * fact(*done, "chi-square"));
  EXPECT_THAT(done->notes, Contains(HasSubstr("what that may miss counts in u")));
  EXPECT_THAT(lines_of("scan-1-against-coarse.csv").front(), HasSubstr("u_interpolation_per_sr"));
}

TEST_F(Comparisons, WhatCannotBeComparedHasItsWord) {
  test::StoredValues store(square_grid(), kTenth);
  const auto elsewhere = store.add(daemon::test::bench_plan({10}, {20, 40}, {90}), kTenth);
  gonio::test::write_text(folder_ / "no.csv", "GIF89a");
  const auto word_for = [&](const api::AnalysisRequest& request, const std::string& file = {}) {
    const auto done = run(store.file(), request, file);
    EXPECT_FALSE(done);
    return done ? std::string() : describe(done.error());
  };

  EXPECT_THAT(word_for({.kind = "compare", .scan = 1}), HasSubstr("another scan, a file, or a model"));
  EXPECT_THAT(word_for({.kind = "compare", .scan = 1, .other_scan = elsewhere}), HasSubstr("no geometry of"));
  EXPECT_THAT(word_for({.kind = "compare", .scan = 1, .other_model = "rpw rho0=1"}), HasSubstr("rpw"));
  EXPECT_THAT(word_for({.kind = "compare", .scan = 1, .other_model = "lambertian rho=much"}), HasSubstr("rho=much"));
  EXPECT_THAT(word_for({.kind = "compare", .scan = 1}, folder_ / "no.csv"), HasSubstr("none of the formats"));
  EXPECT_THAT(word_for({.kind = "repeatability", .scan = 1, .others = {77}}), HasSubstr("no scan of this number"));
}

TEST_F(Comparisons, AFileThatMakesNoSurfaceHasItsWord) {
  const test::StoredValues store(square_grid(), kTenth);
  // The scan's wavelength is a channel of the file, but all readings are of the other one.
  formats::MeasuredBrdf theirs;
  theirs.channels = {formats::channel_at(568.0), formats::channel_at(700.0)};
  for (const double theta_i : {0.0, 30.0}) {
    for (const double theta_r : {0.0, 30.0, 60.0}) {
      for (const double phi : {0.0, 90.0, 180.0})
        theirs.points.push_back(
            {.theta_i_deg = theta_i, .theta_r_deg = theta_r, .phi_r_deg = phi, .f_per_sr = 0.1, .channel = 1});
    }
  }
  ASSERT_TRUE(formats::write_export(folder_ / "empty-channel", formats::write_csv(theirs).value()));
  formats::SurfaceFile grey;
  grey.channels.push_back({.channel = formats::channel_at(550.0),
                           .surface = reflectance::Surface(reflectance::Lambertian::make({.rho = 0.3}).value())});
  ASSERT_TRUE(formats::write_export(folder_ / "grey", formats::write_merl(grey).value()));

  const auto empty = run(store.file(), {.kind = "compare", .scan = 1}, folder_ / "empty-channel.csv");
  const auto merl = run(store.file(), {.kind = "compare", .scan = 1}, folder_ / "grey.binary");

  ASSERT_FALSE(empty);
  EXPECT_THAT(describe(empty.error()), HasSubstr("no reading of it"));
  ASSERT_FALSE(merl);
  EXPECT_EQ(merl.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(describe(merl.error()), HasSubstr("the other has R, G, B")) << "it does not say which wavelengths";
}

TEST_F(Comparisons, SymmetriesAreLookedAtPairByPair) {
  // Broken left and right by 0.008 beside 30 deg of incidence; reciprocal all the same.
  const test::StoredValues store(square_grid(), [](const Geometry& g) {
    const bool is_left = std::sin((g.phi_r - g.phi_i).si()) > 1e-9;
    return is_left && std::abs(in_degrees(g.theta_i) - 30.0) < 1.0 && std::abs(in_degrees(g.theta_r) - 30.0) < 1.0
               ? 0.108
               : 0.1;
  });

  const auto done = run(store.file(), {.kind = "symmetry", .scan = store.id()});

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_GT(fact(*done, "reciprocity pairs"), 5.0);
  EXPECT_GT(fact(*done, "reciprocity p value"), 0.5);
  EXPECT_NEAR(std::abs(fact(*done, "left-right worst z")), 0.008 / std::hypot(0.001, 0.001, 0.00008), 1e-6);
  EXPECT_LT(fact(*done, "left-right p value"), 1e-3);
  EXPECT_EQ(fact(*done, "turns pairs"), 0.0) << "the plan's duplicates at the normal were merged";
  const auto lines = lines_of("scan-1-symmetry-pairs.csv");
  EXPECT_EQ(lines.size(),
            1.0 + fact(*done, "reciprocity pairs") + fact(*done, "left-right pairs") + fact(*done, "turns pairs"));
  EXPECT_THAT(done->files, Contains(testing::Field(&api::AnalysisFile::name, "scan-1-symmetry-left-right.png")));
}

TEST_F(Comparisons, RepeatabilityTellsSpreadBetweenAndWithinTheScansOfACampaign) {
  // Offsets of -1, 0 and 1 %, and at every second azimuth 0.2 % up and down.
  const auto values = [](double offset, double sign) {
    return [=](const Geometry& g) {
      const bool is_odd = std::lround(in_degrees(g.phi_r) / 60.0) % 2 == 1;
      const double ripple = g.theta_r == Angle{} || g.theta_i == Angle{} ? 0.0 : is_odd ? 0.002 : -0.002;
      return 0.1 * (1.0 + offset) * (1.0 + ripple * sign);
    };
  };
  test::StoredValues store(square_grid(), values(-0.01, 1.0));
  const auto second = store.add(square_grid(), values(0.0, -1.0));
  const auto third = store.add(square_grid(), values(0.01, 1.0));
  for (const daemon::ScanId id : {store.id(), second, third}) store.end(id);
  (void)store.add(square_grid(), values(0.5, 1.0));  // not measured to its end

  const auto done = run(store.file(), {.kind = "repeatability", .scan = store.id()});

  ASSERT_TRUE(done) << describe(done.error());
  EXPECT_NEAR(fact(*done, "of it between scans"), 1.0, 0.02);
  EXPECT_GT(fact(*done, "of it within scans"), 0.1);
  EXPECT_LT(fact(*done, "of it within scans"), 0.4);
  EXPECT_NEAR(fact(*done, "mean offset of scan 3"), 1.0, 0.1);
  EXPECT_NEAR(fact(*done, "spread of a point"), 1.0, 0.1);
  // The offsets are of what all three share, the certificate: beside 1 % of u_random they are as large as it.
  EXPECT_NEAR(fact(*done, "spread over stated u"), 1.0, 0.1);
  EXPECT_THAT(lines_of("scan-1-repeatability.csv").front(), HasSubstr("mean_per_sr,spread_per_sr,u_random_per_sr"));

  const auto two = run(store.file(), {.kind = "repeatability", .scan = store.id(), .others = {second}});
  EXPECT_NEAR(fact(*two, "of it between scans"), 0.707, 0.02);
}

TEST(ModelText, IsReadAndWrittenWithTheSameNumbers) {
  for (const char* text :
       {"rpv rho0=0.133 k=0.851 g=-0.114", "1 * lambertian rho=0.1 + 0.5 * ggx roughness=0.2 refractive_index=1.5"}) {
    const auto surface = surface_of_text(text);
    ASSERT_TRUE(surface) << describe(surface.error());
    EXPECT_EQ(text_of_surface(*surface), text);
  }
  EXPECT_FALSE(surface_of_text(""));
  EXPECT_FALSE(surface_of_text("lambertian rho=0.1 +"));
  EXPECT_FALSE(surface_of_text("half * lambertian rho=0.1"));
  EXPECT_FALSE(surface_of_text("lambertian"));
}

}  // namespace
}  // namespace gonio::analysis
