#include "base/toml_reader.h"

#include <gtest/gtest.h>

#include <array>

namespace gonio {
namespace {

constexpr std::string_view kText = R"([scan]
name = "wheat"
[geometry]
theta_i_deg = [0, 30.5]
count = 3
[[filters]]
slot = 1
[[filters]]
slot = 2
)";

TomlReader reader_of(std::string_view text) {
  Result<TomlReader> reader = TomlReader::parse(text, "plan.toml");
  EXPECT_TRUE(reader.has_value());
  return *reader;
}

Error error_of(const TomlReader& reader) {
  const Result<void> result = reader.finish();
  EXPECT_FALSE(result.has_value());
  return result ? Error{} : result.error();
}

TEST(TomlReader, ReadsWhatIsThereAndFinishesClean) {
  TomlReader root = reader_of(kText);

  EXPECT_EQ(root.table("scan").text("name"), "wheat");
  TomlReader geometry = root.table("geometry");
  EXPECT_EQ(geometry.numbers("theta_i_deg"), (std::vector<double>{0.0, 30.5}));
  EXPECT_EQ(geometry.integer("count", 1, 5), 3);
  std::vector<std::int64_t> slots;
  for (TomlReader& filter : root.tables("filters")) slots.push_back(filter.integer("slot", 1, 8));

  EXPECT_EQ(slots, (std::vector<std::int64_t>{1, 2}));
  EXPECT_TRUE(root.finish().has_value());
}

TEST(TomlReader, RefusesAnUnknownKeyWithItsLineAndTheNearestName) {
  TomlReader root = reader_of("[geometry]\ntheta_i_rad = 1\n");
  root.table("geometry").optional_number("theta_i_deg");

  const Error error = error_of(root);

  EXPECT_EQ(error.code, ErrorCode::UnknownKey);
  EXPECT_EQ(error.where, (InputLocation{"plan.toml", 2, "geometry.theta_i_rad"}));
  EXPECT_EQ(error.limit, "did you mean \"theta_i_deg\"?");
}

TEST(TomlReader, RefusesATableThatNobodyAskedFor) {
  TomlReader root = reader_of("[scam]\nname = 1\n");
  root.optional_table("scan");

  const Error error = error_of(root);

  EXPECT_EQ(error.where, (InputLocation{"plan.toml", 1, "scam"}));
}

TEST(TomlReader, PointsFromAMissingKeyToTheStrangerInItsTable) {
  TomlReader root = reader_of("[geometry]\ntheta_r_deg = [1]\ntheta_i_rad = [0]\n[other]\nx = 1\n");
  TomlReader geometry = root.table("geometry");
  geometry.numbers("theta_i_deg");
  geometry.numbers("theta_r_deg");

  const Error error = error_of(root);

  EXPECT_EQ(error.code, ErrorCode::MissingKey);
  EXPECT_EQ(error.where, (InputLocation{"plan.toml", 1, "geometry.theta_i_deg"}));
  EXPECT_EQ(error.limit, "line 3 has \"theta_i_rad\": misspelt?");
}

TEST(TomlReader, NamesTheMissingKey) {
  TomlReader root = reader_of("[scan]\n");
  root.table("scan").text("name");

  const Error error = error_of(root);

  EXPECT_EQ(error.code, ErrorCode::MissingKey);
  EXPECT_EQ(error.where->field, "scan.name");
}

TEST(TomlReader, NamesValueUnitAndRange) {
  TomlReader root = reader_of("theta_deg = 97.2\n");
  root.number("theta_deg", {.least = 0, .most = 90, .unit = "deg"});

  const Error error = error_of(root);

  EXPECT_EQ(error.seen, "value 97.2 deg");
  EXPECT_EQ(error.limit, "0 to 90 deg");
  EXPECT_EQ(error.where->line, 1);
}

TEST(TomlReader, RefusesNumbersThatAreNotFinite) {
  TomlReader root = reader_of("a = nan\n");
  root.number("a");
  EXPECT_EQ(error_of(root).seen, "the value is not finite");
}

TEST(TomlReader, RefusesAnotherKindOfValue) {
  TomlReader root = reader_of("a = \"12\"\n");
  root.number("a");
  EXPECT_EQ(error_of(root).seen, "found a text");
}

TEST(TomlReader, ListsTheChoices) {
  TomlReader root = reader_of("strategy = \"quickest\"\n");
  constexpr std::array<std::string_view, 2> kChoices{"fastest", "random"};
  root.choice("strategy", kChoices);

  const Error error = error_of(root);

  EXPECT_EQ(error.seen, "found \"quickest\"");
  EXPECT_EQ(error.limit, "one of: fastest, random");
}

TEST(TomlReader, KeepsTheFirstErrorAndStaysHarmlessAfterIt) {
  TomlReader root = reader_of("b = 1\n");
  TomlReader missing = root.table("a");
  missing.number("x");
  missing.table("y").text("z");
  root.text("b");

  EXPECT_EQ(error_of(root).where->field, "a");
}

TEST(TomlReader, SaysWhereTheTextIsNotToml) {
  const Result<TomlReader> reader = TomlReader::parse("a = 1\nb = = 2\n", "x.toml");

  ASSERT_FALSE(reader.has_value());
  EXPECT_EQ(reader.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(reader.error().where->line, 2);
}

TEST(TomlReader, SaysWhenTheFileCannotBeRead) {
  const Result<TomlReader> reader = TomlReader::parse_file("/no/such/file.toml");

  ASSERT_FALSE(reader.has_value());
  EXPECT_EQ(reader.error().code, ErrorCode::FileUnreadable);
  EXPECT_EQ(reader.error().where->file, "/no/such/file.toml");
}

TEST(TomlReader, ReadsDates) {
  TomlReader root = reader_of("expires = 2027-11-03\n");
  EXPECT_EQ(root.date("expires"), "2027-11-03");
  EXPECT_TRUE(root.finish().has_value());
}

}  // namespace
}  // namespace gonio
