#include "base/utc_text.h"

#include <gtest/gtest.h>

namespace gonio {
namespace {

TEST(UtcText, ReadsMinutesSecondsAndPartsOfThem) {
  // 1 795 370 700 s: `date -u -d 2026-11-22T18:05Z +%s`
  const UtcTime evening{std::chrono::seconds(1'795'370'700)};

  EXPECT_EQ(utc_from_iso8601("2026-11-22T18:05Z"), evening);
  EXPECT_EQ(utc_from_iso8601("2026-11-22T18:05:07Z"), evening + std::chrono::seconds(7));
  EXPECT_EQ(utc_from_iso8601("2026-11-22T18:05:07.250Z"), evening + std::chrono::milliseconds(7250));
}

TEST(UtcText, ReadsWhatIso8601Wrote) {
  const UtcTime moment{std::chrono::milliseconds(1'700'000'000'123)};

  EXPECT_EQ(utc_from_iso8601(iso8601(moment)), moment);
}

TEST(UtcText, RefusesOtherTimesAndDaysThatThereAreNot) {
  for (const char* text : {"", "now", "2026-11-22", "2026-11-22T18:05", "2026-11-22T18:05+01:00", "2026-02-29T00:00Z",
                           "2026-13-01T00:00Z", "2026-11-22T24:00Z", "2026-11-22T18:60Z", "2026-11-22T18:05:07.Z",
                           "2026-11-22T18:05Zx", "2026-11-22T-1:05Z", "22-11-2026T18:05Z"}) {
    EXPECT_FALSE(utc_from_iso8601(text)) << text;
  }
}

}  // namespace
}  // namespace gonio
