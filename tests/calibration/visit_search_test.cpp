#include "calibration/visit_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace gonio::calibration {
namespace {

struct Visit {
  Instant at{};
};

Instant at(std::int64_t ns) {
  return Instant(Duration(ns));
}

std::size_t halved(const std::vector<Visit>& visits, Instant when) {
  return static_cast<std::size_t>(std::ranges::lower_bound(visits, when, {}, &Visit::at) - visits.begin());
}

TEST(VisitSearch, FindsWhatHalvingFindsHoweverUnevenlyVisitsCome) {
  constexpr std::uint64_t kSeed = 20260301;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 random(kSeed);
  for (const std::size_t size : {0U, 1U, 2U, 3U, 7U, 100U}) {
    for (const std::int64_t longest : {2, 1000, 1'000'000'000}) {  // of a gap: many at once, and far apart
      std::vector<Visit> visits;
      std::int64_t now = 0;
      for (std::size_t n = 0; n < size; ++n) {
        now += static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n % 5 == 0 ? longest : 3));
        visits.push_back({at(now)});
      }

      for (std::int64_t look = -1; look <= 200; ++look) {
        const Instant when = at(look <= 0 ? look : (now + 2) * look / 199);
        EXPECT_EQ(first_not_before(visits, when), halved(visits, when)) << size << " visits, look " << look;
      }
      for (const Visit& visit : visits) EXPECT_EQ(first_not_before(visits, visit.at), halved(visits, visit.at));
    }
  }
}

}  // namespace
}  // namespace gonio::calibration
