// What a bad scan is told, by the program that goniod starts: its exit code, its word, and what it leaves behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "base/error.h"
#include "protocol/api/json.h"
#include "tests/daemon/analysis/stored_scans.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace gonio::analysis {
namespace {

using testing::HasSubstr;

constexpr std::chrono::seconds kPatience{120};

class BadInput : public testing::Test {
 protected:
  gonio::test::Finished analyse(const std::string& store, api::AnalysisRequest request) {
    request.deadline_s = 60.0;
    return gonio::test::run_program(
        {GONIO_ANALYSE, "--store", store, "--into", results_.path(), "--plain", "--job", api::to_json(request)},
        scratch_.path(), kPatience);
  }
  [[nodiscard]] std::size_t results() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(results_.path()), {}));
  }

  gonio::test::TemporaryFolder results_;
  gonio::test::TemporaryFolder scratch_;
};

api::Plan rings(const std::vector<double>& theta_i_deg) {
  return daemon::test::bench_plan(theta_i_deg, {0, 20, 40, 60}, {0, 60, 120, 180});
}

const auto kGrey = [](const Geometry&) { return 0.5 / std::numbers::pi; };

TEST_F(BadInput, AnEmptyScanHasItsWordAndLeavesNothing) {
  test::StoredValues store(rings({0, 30}), kGrey);
  const auto empty = store.add_empty(rings({0, 30}));
  for (const char* kind : {"export", "describe", "plot", "report", "quantities", "fit", "compare", "symmetry"}) {
    SCOPED_TRACE(kind);

    const auto done = analyse(store.file(), {.kind = kind, .scan = empty, .format = "bird", .other_scan = store.id()});

    EXPECT_EQ(done.exit_code, traits(ErrorCode::InvalidInput).exit_code);
    EXPECT_THAT(done.errors, HasSubstr("no value: "));
    EXPECT_EQ(results(), 0U);
  }
}

TEST_F(BadInput, OneIncidenceGivesWhatItCanAndSaysSo) {
  const test::StoredValues store(rings({30}), kGrey);
  for (const char* kind : {"quantities", "fit", "plot", "symmetry"}) {
    SCOPED_TRACE(kind);

    const auto done = analyse(store.file(), {.kind = kind, .scan = store.id()});

    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_THAT(done.errors, HasSubstr("one theta_i only"));
  }
}

TEST_F(BadInput, AScanWhoseEveryPointIsFlaggedSaysWhichFlags) {
  const test::StoredValues store(rings({0, 30}), kGrey, 0b101);
  for (const char* kind : {"quantities", "fit", "symmetry"}) {
    SCOPED_TRACE(kind);

    const auto done = analyse(store.file(), {.kind = kind, .scan = store.id()});

    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_THAT(done.errors, HasSubstr("every value is flagged: near-zero, few-neighbours"));
  }
}

// A model is what needs no second scan. A report needs an instrument, which these stores have not.
TEST_F(BadInput, OneIncidenceAndFlagsAreSaidByEveryOtherJobToo) {
  test::StoredValues store(rings({30}), kGrey, 0b101);
  for (const char* kind : {"describe", "compare", "export"}) {
    SCOPED_TRACE(kind);

    const auto done = analyse(
        store.file(), {.kind = kind, .scan = store.id(), .format = "bird", .other_model = "lambertian rho=0.5"});

    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_THAT(done.errors, HasSubstr("one theta_i only"));
    EXPECT_THAT(done.errors, HasSubstr("every value is flagged: near-zero, few-neighbours"));
  }
}

}  // namespace
}  // namespace gonio::analysis
