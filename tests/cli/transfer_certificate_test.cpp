#include "cli/transfer_certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/import_reference.h"
#include "tests/calibration/reference_text.h"

namespace gonio::cli {
namespace {

using testing::HasSubstr;

// 480 and 568 nm, u 0.004 and 0.005, of which 0.8 goes together.
api::CalibrationReport transfer() {
  return {.version = 7,
          .job = "transfer",
          .scan = 12,
          .sample = "WORK-3",
          .utc = "2026-11-22T18:05:00Z",
          .note = "from SRT-99-020, 4 points at 0/45",
          .values = {{"reff_0_45_480nm", "1", 0.951234, 0.004}, {"reff_0_45_568nm", "1", 0.962345, 0.005}},
          .covariance = {1.6e-5, 1.6e-5, 1.6e-5, 2.5e-5}};
}

TEST(TransferCertificate, SaysWhatTheWorkingStandardHasFromItsMaster) {
  const auto csv = certificate_csv(transfer(), "2027-11-22", 20.0);

  ASSERT_TRUE(csv) << describe(csv.error());
  EXPECT_EQ(*csv,
            "# serial: WORK-3\n"
            "# material: working standard, from SRT-99-020, 4 points at 0/45, scan 12, calibration 7\n"
            "# date: 2026-11-22\n"
            "# expires: 2027-11-22\n"
            "# geometry: 0/45\n"
            "# coverage_factor: 2\n"
            "# uncertainty_kind: absolute\n"
            "# correlation: 0.8000\n"
            "# longest_gap_nm: 20\n"
            "wavelength_nm,reflectance,uncertainty\n"
            "480,0.951234,0.008000\n"
            "568,0.962345,0.010000\n");
}

TEST(TransferCertificate, IsTakenByAnImportWithTheMastersShape) {
  const auto csv = certificate_csv(transfer(), "2027-11-22", 1.0);
  const auto master = calibration::ReferenceStandard::parse(calibration::ReferenceText{}.text(), "master.toml");
  ASSERT_TRUE(csv && master);

  const auto imported = calibration::import_reference({.text = *csv, .file = "work-3.csv", .shape_from = &*master});

  ASSERT_TRUE(imported) << describe(imported.error());
  const auto rho = imported->standard.reflectance(nanometres(568.0));
  ASSERT_TRUE(rho) << describe(rho.error());
  EXPECT_NEAR(rho->value, 0.962345, 1e-12);
  EXPECT_NEAR(rho->u, 0.005, 1e-12);
  EXPECT_NEAR(imported->standard.certificate().correlation, 0.8, 1e-12);
}

TEST(TransferCertificate, IsRefusedOfAnotherJobAndWhereNothingWasFound) {
  api::CalibrationReport ladder = transfer();
  ladder.job = "linearity";
  api::CalibrationReport empty = transfer();
  empty.values.clear();
  empty.covariance.clear();

  EXPECT_THAT(describe(certificate_csv(ladder, "2027-11-22", 1.0).error()), HasSubstr("of the job linearity"));
  EXPECT_THAT(describe(certificate_csv(empty, "2027-11-22", 1.0).error()), HasSubstr("no reflectance factor"));
}

}  // namespace
}  // namespace gonio::cli
