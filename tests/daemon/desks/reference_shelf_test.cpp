#include "daemon/desks/reference_shelf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"

namespace gonio::daemon {
namespace {

using testing::HasSubstr;

// A standard whose shape is 1 everywhere.
std::string standard(const std::string& serial) {
  std::string values;
  for (int i = 0; i < 3 * 3 * 2; ++i) values += "1.0,";
  return "[standard]\nserial = \"" + serial +
         "\"\nmaterial = \"white\"\n[certificate]\ndate = 2025-11-03\nexpires = 2027-11-03\n"
         "geometry = \"8/h\"\nspecular = \"included\"\ncoverage_factor = 2.0\nuncertainty_kind = \"absolute\"\n"
         "[[certificate.entries]]\nwavelength_nm = 568.0\nreflectance = 0.99\nuncertainty = 0.005\n"
         "[shape]\ntheta_i_deg = [0, 45, 85]\ntheta_r_deg = [0, 45, 85]\nphi_deg = [0, 180]\nvalues = [" +
         values + "]\nu_integral = 0.001\n";
}

TEST(ReferenceShelf, FindsAStandardBySerialNumberWhateverItsFileIsCalled) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "a.toml", standard("SRT-1"));
  test::write_text(folder / "b.toml", standard("SRT-2"));
  test::write_text(folder / "notes.txt", "nothing");

  const Result<ShelfEntry> found = ReferenceShelf(folder.path()).find("SRT-2");

  ASSERT_TRUE(found.has_value()) << describe(found.error());
  EXPECT_EQ(found->file, folder / "b.toml");
  EXPECT_EQ(found->text, standard("SRT-2"));
}

TEST(ReferenceShelf, AnUnknownStandardNamesThoseThereAre) {
  const test::TemporaryFolder folder;
  test::write_text(folder / "a.toml", standard("SRT-1"));

  const Result<ShelfEntry> found = ReferenceShelf(folder.path()).find("SRT-9");

  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(found.error().limit, HasSubstr("SRT-1"));
}

TEST(ReferenceShelf, ABrokenFileIsTheAnswerForTheStandardOfItsName) {
  const test::TemporaryFolder folder;
  std::string text = standard("SRT-3");
  text.replace(text.find("coverage_factor = 2.0"), 21, "");
  test::write_text(folder / "SRT-3.toml", text);
  test::write_text(folder / "a.toml", standard("SRT-1"));

  const ReferenceShelf shelf(folder.path());

  EXPECT_EQ(shelf.find("SRT-3").error().code, ErrorCode::ReferenceIncomplete);
  EXPECT_TRUE(shelf.find("SRT-1").has_value());
  EXPECT_EQ(shelf.all().size(), 2U);
}

TEST(ReferenceShelf, AFolderThatIsNotThereIsEmpty) {
  EXPECT_TRUE(ReferenceShelf("/nowhere/at/all").all().empty());
  EXPECT_EQ(ReferenceShelf("/nowhere/at/all").find("x").error().code, ErrorCode::InvalidInput);
}

TEST(ReferenceShelf, ANewCertificateCountsFromTheNextAsking) {
  const test::TemporaryFolder folder;
  const ReferenceShelf shelf(folder.path());
  EXPECT_FALSE(shelf.find("SRT-1").has_value());

  test::write_text(folder / "a.toml", standard("SRT-1"));

  EXPECT_TRUE(shelf.find("SRT-1").has_value());
}

}  // namespace
}  // namespace gonio::daemon
