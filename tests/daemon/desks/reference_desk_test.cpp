#include "daemon/desks/reference_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/calibration/reference_text.h"
#include "tests/support/process.h"

namespace gonio::daemon {
namespace {

using testing::HasSubstr;

const UtcTime kNow{std::chrono::sys_days{std::chrono::year{2026} / 11 / 22}};

std::string standard(const std::string& serial, const std::string& material = "white") {
  calibration::ReferenceText text;
  text.standard = "serial = \"" + serial + "\"\nmaterial = \"" + material + "\"\n";
  return text.text();
}

// As an open model of Spectralon has it: 10 % between 10/70 and 70/10.
std::string not_reciprocal() {
  calibration::ReferenceText text;
  text.shape = [](double i, double r, double) { return 1.0 + 0.0008 * (r - i); };
  return text.text();
}

class ReferenceDesk : public testing::Test {
 protected:
  Result<api::ReferenceReport> import(const std::string& text, bool replace = false) {
    return import_to_shelf({.text = text, .file = "mine.toml", .replace = replace}, shelf_, kNow);
  }
  std::size_t files() const {
    const std::filesystem::directory_iterator folder(shelf_.folder());
    return static_cast<std::size_t>(std::distance(begin(folder), end(folder)));
  }

  const test::TemporaryFolder folder_;
  const ReferenceShelf shelf_{folder_ / "reference"};  // not there yet
};

TEST_F(ReferenceDesk, PutsAStandardOnTheShelfAsItWasWritten) {
  const auto imported = import(standard("SRT-1"));

  ASSERT_TRUE(imported) << describe(imported.error());
  EXPECT_THAT(imported->note, HasSubstr("written to"));
  EXPECT_EQ(imported->table, "sound");
  const auto found = shelf_.find("SRT-1");
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_EQ(found->text, standard("SRT-1"));
  EXPECT_EQ(files(), 1U);  // nothing is left aside
}

TEST_F(ReferenceDesk, TheSameTextAgainWritesNothing) {
  ASSERT_TRUE(import(standard("SRT-1")));

  const auto again = import(standard("SRT-1"));

  ASSERT_TRUE(again) << describe(again.error());
  EXPECT_THAT(again->note, HasSubstr("nothing was written"));
}

TEST_F(ReferenceDesk, AnotherTextOfTheSameSerialNumberIsRefusedUnlessItIsToldTo) {
  ASSERT_TRUE(import(standard("SRT-1")));

  const auto refused = import(standard("SRT-1", "whiter"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::WrongState);
  EXPECT_EQ(shelf_.find("SRT-1")->text, standard("SRT-1"));

  const auto replaced = import(standard("SRT-1", "whiter"), true);
  ASSERT_TRUE(replaced) << describe(replaced.error());
  EXPECT_EQ(replaced->material, "whiter");
  EXPECT_THAT(replaced->note, HasSubstr("until-2026-11-22"));
  EXPECT_EQ(shelf_.all().size(), 1U);
  EXPECT_EQ(files(), 2U);  // the old text beside it
}

TEST_F(ReferenceDesk, ReplacesTheFileThatHasTheSerialNumberWhateverItsName) {
  std::filesystem::create_directories(shelf_.folder());
  test::write_text(shelf_.folder() + "/white.toml", standard("SRT-1"));

  const auto replaced = import(standard("SRT-1", "whiter"), true);

  ASSERT_TRUE(replaced) << describe(replaced.error());
  EXPECT_EQ(replaced->file, shelf_.folder() + "/white.toml");
  EXPECT_EQ(shelf_.all().size(), 1U);
}

TEST_F(ReferenceDesk, ATableThatContradictsItselfIsNotTakenAndOneOnTheShelfIsNoStandard) {
  const auto refused = import(not_reciprocal());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(refused.error().seen, HasSubstr("breaks reciprocity"));

  std::filesystem::create_directories(shelf_.folder());
  test::write_text(shelf_.folder() + "/SRT-1.toml", not_reciprocal());
  const auto found = shelf_.find("SRT-1");
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().seen, HasSubstr("breaks reciprocity"));
  EXPECT_TRUE(reference_report(shelf_.all().at(0)).error.has_value());
}

TEST_F(ReferenceDesk, ChecksATableWithoutTakingIt) {
  const auto checked = check_import({.text = not_reciprocal(), .file = "mine.toml"}, shelf_);

  ASSERT_TRUE(checked) << describe(checked.error());
  EXPECT_EQ(checked->table, "contradicts itself");
  EXPECT_FALSE(checked->findings.empty());
  EXPECT_TRUE(shelf_.all().empty());
}

TEST_F(ReferenceDesk, ASerialNumberThatIsNoFileNameIsRefused) {
  const auto refused = import(standard("../../etc/x"));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
  EXPECT_TRUE(shelf_.all().empty());
}

TEST_F(ReferenceDesk, ShowsAStandardInFullAndNamesThoseThereAreForAnUnknownOne) {
  ASSERT_TRUE(import(standard("SRT-1")));

  const auto full = reference_in_full(shelf_, "SRT-1");
  ASSERT_TRUE(full) << describe(full.error());
  EXPECT_EQ(full->text, standard("SRT-1"));
  ASSERT_EQ(full->entries.size(), 1U);
  EXPECT_DOUBLE_EQ(full->entries[0].u, 0.003);
  EXPECT_EQ(full->coverage_factor, 2.0);

  const auto unknown = reference_in_full(shelf_, "SRT-9");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::NotFound);
  EXPECT_THAT(unknown.error().limit, HasSubstr("SRT-1"));
}

TEST_F(ReferenceDesk, BorrowsTheShapeOfAStandardOfTheShelf) {
  ASSERT_TRUE(import(standard("SRT-1")));
  const std::string certificate =
      "# serial: SRT-2\n# date: 2026-03-01\n# expires: 2028-03-01\n# geometry: 8/h\n# specular: included\n"
      "# coverage_factor: 2\n# uncertainty_kind: relative\nwavelength_nm,reflectance,uncertainty\n568,0.985,0.005\n";

  const auto imported = import_to_shelf({.text = certificate, .file = "c.csv", .shape_of = "SRT-1"}, shelf_, kNow);

  ASSERT_TRUE(imported) << describe(imported.error());
  EXPECT_TRUE(shelf_.find("SRT-2"));
}

}  // namespace
}  // namespace gonio::daemon
