#include "reflectance/convention/notation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace gonio::reflectance {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Notation, KnowsThatHapkesGIsOurPhaseAngleAndHisXiOurAsymmetry) {
  EXPECT_EQ(find_symbol(Notation::Hapke, "g"), find_symbol(Notation::Notes, "xi"));
  EXPECT_EQ(find_symbol(Notation::Hapke, "xi"), find_symbol(Notation::Notes, "g"));
  EXPECT_EQ(find_symbol(Notation::Hapke, "w"), find_symbol(Notation::Notes, "omega0"));
  EXPECT_EQ(find_symbol(Notation::Hapke, "I"), find_symbol(Notation::Notes, "L"));
  EXPECT_NE(find_symbol(Notation::Hapke, "psi"), find_symbol(Notation::Notes, "psi"));
}

TEST(Notation, NamesTheBrdfInEveryBook) {
  const NotationRow* brdf = find_symbol(Notation::Notes, "BRDF");

  ASSERT_NE(brdf, nullptr);
  EXPECT_EQ(find_symbol(Notation::Nbs160, "f_r"), brdf);
  EXPECT_EQ(find_symbol(Notation::Hapke, "r/mu_0"), brdf);
  EXPECT_EQ(find_symbol(Notation::LightAndWater, "r/cos(theta')"), brdf);
}

TEST(Notation, ListsTheSymbolsThatMeanTwoThings) {
  const std::vector<std::string_view> clashing = clashing_symbols();

  for (const char* symbol : {"g", "xi", "psi", "theta", "Omega"}) EXPECT_THAT(clashing, Contains(symbol));
  EXPECT_THAT(clashing, Not(Contains("theta_i")));
  EXPECT_THAT(clashing, Not(Contains("omega0")));
}

TEST(Notation, HasNoSymbolThatABookDoesNotUse) {
  EXPECT_EQ(find_symbol(Notation::Nbs160, "omega0"), nullptr);
  EXPECT_EQ(find_symbol(Notation::Hapke, ""), nullptr);
}

TEST(Notation, UsesEachSymbolOnceInABook) {
  const auto expect_found = [](Notation book, std::string_view symbol, const NotationRow& row) {
    EXPECT_EQ(find_symbol(book, symbol), symbol.empty() ? nullptr : &row) << symbol;
  };
  for (const NotationRow& row : notation_rows()) {
    expect_found(Notation::Notes, row.notes, row);
    expect_found(Notation::Hapke, row.hapke, row);
    expect_found(Notation::Nbs160, row.nbs160, row);
    expect_found(Notation::LightAndWater, row.light_and_water, row);
  }
}

TEST(Notation, StandsInItsDocumentAsItIs) {
  std::ifstream file(GONIO_SOURCE_DIR "/reflectance/convention/NOTATION.md");
  std::stringstream text;
  text << file.rdbuf();

  EXPECT_THAT(text.str(), HasSubstr(notation_table()));
}

}  // namespace
}  // namespace gonio::reflectance
