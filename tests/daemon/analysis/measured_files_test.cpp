// Files of other laboratories through the worker program's jobs, and ours before the published schema. Neither is part
// of the project: in $GONIO_SHARED, else beside the source tree; a test that finds none says so and checks nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <sstream>

#include "daemon/analysis/input_file.h"
#include "daemon/analysis/job.h"
#include "tests/daemon/analysis/stored_scans.h"
#include "tests/reflectance/formats/bird_checker.h"
#include "tests/reflectance/formats/shared_data.h"
#include "tests/support/process.h"

namespace gonio::analysis {
namespace {

Result<api::AnalysisReport> job_on_file(const std::string& file, const std::string& kind, const std::string& format,
                                        const std::string& folder) {
  std::ostringstream told;
  Progress progress(Progress::Form::Lines, told, told, false);
  return run_job({.request = {.kind = kind, .format = format},
                  .store_file = {},
                  .input_file = file,
                  .folder = folder,
                  .name = "made"},
                 progress);
}

class MeasuredFile : public testing::TestWithParam<const char*> {
 protected:
  const std::string path_ = (formats::shared_folder() / "data/measured" / GetParam()).string();
  const bool is_there_ = std::filesystem::exists(path_);
  gonio::test::TemporaryFolder folder_;
};

TEST_P(MeasuredFile, IsReadIntegratedAndWrittenAgain) {
  if (!is_there_) {
    std::cout << "no " << path_ << ": nothing checked\n";
    return;
  }
  const auto described = job_on_file(path_, "describe", "", folder_.path());
  ASSERT_TRUE(described) << describe(described.error());
  long integrals = 0;
  for (const api::AnalysisFact& fact : described->facts) {
    if (!fact.name.starts_with("rho_dh")) continue;
    ++integrals;
    EXPECT_GT(fact.value, 0.0) << fact.name;
    EXPECT_LT(fact.value, 1.0) << fact.name << ": no surface sends back more than it gets";
  }
  EXPECT_GE(integrals, 3);

  const auto made = job_on_file(path_, "export", "csv+json", folder_.path());
  ASSERT_TRUE(made) << describe(made.error());
  const auto first = read_input_file(path_);
  const auto again = read_input_file(folder_ / "made.csv");
  ASSERT_TRUE(again) << describe(again.error());
  EXPECT_EQ(first->brdf, again->brdf) << "our own format loses nothing, to the bit";
}

INSTANTIATE_TEST_SUITE_P(Files, MeasuredFile, testing::Values("retro-3m-yellow.alta", "anoblack-ec1.zemax.bsdf"),
                         [](const auto& of) {
                           std::string name = of.param;
                           std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
                           return name;
                         });

TEST(BirdExport, OfAStoredScanPassesThePublishedSchema) {
  const test::StoredValues store(daemon::test::bench_plan({0, 30}, {0, 30, 60}, {0, 90, 180}), test::bright_at_retro);
  const gonio::test::TemporaryFolder folder;
  std::ostringstream told;
  Progress progress(Progress::Form::Lines, told, told, false);
  const auto made = run_job({.request = {.kind = "export", .scan = store.id(), .format = "bird"},
                             .store_file = store.file(),
                             .input_file = {},
                             .folder = folder.path(),
                             .name = "scan"},
                            progress);
  ASSERT_TRUE(made) << describe(made.error());

  const auto checked = formats::checked_by_ajv({folder / "scan.brdf"}, folder.path());

  if (!checked) {
    std::cout << "no BiRD schema in " << formats::shared_folder() << ": nothing checked\n";
    return;
  }
  EXPECT_EQ(checked->exit_code, 0) << checked->output << checked->errors;
}

}  // namespace
}  // namespace gonio::analysis
