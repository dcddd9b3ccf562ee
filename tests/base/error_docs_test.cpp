// docs/errors.md is made from the table of codes, so that the operator's page cannot disagree with the program.
// To write it anew: GONIO_WRITE_DOCS=1 test_base --gtest_filter='ErrorDocs.*'
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "base/error.h"

namespace gonio {
namespace {

const std::string kPage = std::string(GONIO_SOURCE_DIR) + "/docs/errors.md";

std::string_view retry_words(Retry retry) {
  switch (retry) {
    case Retry::Never:
      return "no";
    case Retry::Again:
      return "by itself, a bounded number of times";
    case Retry::AfterOperator:
      return "after you have acted";
  }
  return "";
}

std::string page_text() {
  std::string text =
      "# Errors: what you see, what it means, what to do\n\n"
      "Every error of `goniod` and `gonioctl` carries one of these codes in square brackets. This page is made from "
      "the table in "
      "`base/error.cpp`.\n\n"
      "| code | what it is | for the data | what to do | tried again? | HTTP | exit |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const ErrorTraits& row : all_error_traits()) {
    text += "| `" + std::string(row.name) + "` | " + std::string(row.title) + " | " + std::string(row.for_the_data) +
            " | " + std::string(row.remedy) + " | " + std::string(retry_words(row.retry)) + " | " +
            std::to_string(row.http_status) + " | " + std::to_string(row.exit_code) + " |\n";
  }
  return text;
}

TEST(ErrorDocs, SayWhatTheTableSays) {
  if (std::getenv("GONIO_WRITE_DOCS") != nullptr) std::ofstream(kPage) << page_text();
  std::ifstream in(kPage);
  const std::string written((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_EQ(written, page_text()) << "docs/errors.md is not up to date; see the head of this test";
}

}  // namespace
}  // namespace gonio
