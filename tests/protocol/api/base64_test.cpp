#include "protocol/api/base64.h"

#include <gtest/gtest.h>

namespace gonio::api {
namespace {

// RFC 4648, section 10.
TEST(Base64, WritesAndReadsTheTestVectorsOfTheStandard) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(to_base64(bytes), text);
    EXPECT_EQ(from_base64(text).value(), bytes);
  }
}

TEST(Base64, KeepsEveryByte) {
  std::string all;
  for (int k = 0; k < 256; ++k) all += static_cast<char>(k);

  EXPECT_EQ(from_base64(to_base64(all)).value(), all);
}

TEST(Base64, RefusesWhatIsNone) {
  for (const char* text : {"Zg", "Zg=", "Z===", "Zm9v!m9v", "Zg==Zg==", "Zm 9"}) {
    SCOPED_TRACE(text);
    EXPECT_EQ(from_base64(text).error().code, ErrorCode::InvalidInput);
  }
}

}  // namespace
}  // namespace gonio::api
