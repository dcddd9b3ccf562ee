#include "calibration/map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/map_bytes.h"

namespace gonio::calibration {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::HasSubstr;

// One pixel, one layer, byte by byte; the FNV-1a of 00 00 80 3f by hand: the offset basis through four steps.
TEST(MapFile, ReadsAFileWrittenByHand) {
  Bytes bytes{'G', 'O', 'N', 'I', 'O', 'M', 'A', 'P', 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  bytes.insert(bytes.end(), {0, 0, 0, 0, 0, 0, 0xE0, 0x3F});  // 0.5
  bytes.insert(bytes.end(), 24, 0);
  std::uint64_t sum = 14695981039346656037U;
  for (const unsigned byte : {0x00U, 0x00U, 0x80U, 0x3FU}) sum = (sum ^ byte) * 1099511628211U;
  for (int k = 0; k < 8; ++k) bytes.push_back(static_cast<std::uint8_t>(sum >> (8 * k)));
  bytes.insert(bytes.end(), {0x00, 0x00, 0x80, 0x3F});  // 1.0

  const auto map = parse_map_file(bytes, "flat.map");

  ASSERT_TRUE(map) << describe(map.error());
  EXPECT_EQ(map->width, 1);
  EXPECT_EQ(map->height, 1);
  EXPECT_EQ(map->layers, (std::vector<std::vector<float>>{{1.0F}}));
  EXPECT_EQ(map->u, (std::array<double, 4>{0.5, 0.0, 0.0, 0.0}));
}

TEST(MapFile, ReadsLayersOneAfterTheOther) {
  const auto map = parse_map_file(test::map_bytes(2, 1, {{1.5F, -2.0F}, {0.25F, 8.0F}}, {0.1, 0.2}), "dark.map");

  ASSERT_TRUE(map) << describe(map.error());
  EXPECT_EQ(map->layers, (std::vector<std::vector<float>>{{1.5F, -2.0F}, {0.25F, 8.0F}}));
  EXPECT_EQ(map->u[1], 0.2);
}

TEST(MapFile, IsWrittenAsTheFormatIsDescribed) {
  const MapFile map{.width = 2, .height = 1, .layers = {{1.5F, -2.0F}, {0.25F, 8.0F}}, .u = {0.1, 0.2}};
  const Bytes described = test::map_bytes(2, 1, {{1.5F, -2.0F}, {0.25F, 8.0F}}, {0.1, 0.2});

  EXPECT_EQ(map_file_bytes(map), std::string(described.begin(), described.end()));
}

TEST(MapFile, FindsOneWrongBitInTheValues) {
  Bytes bytes = test::map_bytes(2, 2, {{1, 2, 3, 4}});
  bytes.back() ^= 1U;

  const auto map = parse_map_file(bytes, "flat.map");

  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(map.error().tried, HasSubstr("flat.map"));
  EXPECT_THAT(map.error().seen, HasSubstr("a sum of"));
}

TEST(MapFile, RefusesWhatIsNoMap) {
  Bytes cut = test::map_bytes(2, 2, {{1, 2, 3, 4}});
  cut.pop_back();
  Bytes other = test::map_bytes(2, 2, {{1, 2, 3, 4}});
  other[0] = 'X';
  Bytes newer = test::map_bytes(2, 2, {{1, 2, 3, 4}});
  newer[8] = 2;
  Bytes huge = test::map_bytes(2, 2, {{1, 2, 3, 4}});
  huge[15] = 0xFF;
  const Bytes flat_without_layers = test::map_bytes(2, 2, {});
  const Bytes unsure = test::map_bytes(1, 1, {{1}}, {-1.0});
  const Bytes unknown = test::map_bytes(1, 1, {{1}}, {NAN});

  for (const Bytes& bytes : {Bytes{}, cut, other, newer, huge, flat_without_layers, unsure, unknown}) {
    const auto map = parse_map_file(bytes, "a.map");
    ASSERT_FALSE(map);
    EXPECT_EQ(map.error().code, ErrorCode::InvalidInput);
  }
}

}  // namespace
}  // namespace gonio::calibration
