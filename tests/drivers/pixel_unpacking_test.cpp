// Bytes as GigE Vision 2.0 (section 25.2, "Packed") and GenICam's Pixel Format Naming Convention 2.1 ("p") lay them
// out.
#include "drivers/links/pixel_unpacking.h"

#include <gtest/gtest.h>

namespace gonio::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Pixels = std::vector<std::uint16_t>;

Pixels unpacked(std::string_view name, const Bytes& bytes, std::size_t pixels) {
  const auto format = pixel_format_of_name(name);
  EXPECT_TRUE(format) << name;
  return unpack(*format, bytes, pixels);
}

TEST(PixelUnpacking, TakesOneByteAPixelAsItIs) {
  EXPECT_EQ(unpacked("Mono8", {0x00, 0x7F, 0xFF}, 3), (Pixels{0x00, 0x7F, 0xFF}));
}

TEST(PixelUnpacking, TakesTwoBytesLowByteFirst) {
  EXPECT_EQ(unpacked("Mono16", {0x34, 0x12, 0xFF, 0xFF}, 2), (Pixels{0x1234, 0xFFFF}));
  EXPECT_EQ(unpacked("Mono14", {0xFF, 0x3F}, 1), (Pixels{0x3FFF}));
}

TEST(PixelUnpacking, ClearsBitsAboveTheSignificantOnes) {
  EXPECT_EQ(unpacked("Mono12", {0x23, 0xF1}, 1), (Pixels{0x123}));
  EXPECT_EQ(unpacked("Mono10", {0xFF, 0xFF}, 1), (Pixels{0x3FF}));
}

// Mono12Packed: A[11:4], B[3:0] A[3:0], B[11:4]. A = 0x123, B = 0xABC.
TEST(PixelUnpacking, TakesTwelveBitsPackedByGigeVision) {
  EXPECT_EQ(unpacked("Mono12Packed", {0x12, 0xC3, 0xAB}, 2), (Pixels{0x123, 0xABC}));
}

// Mono10Packed: A[9:2], 00 B[1:0] 00 A[1:0], B[9:2]. A = 0x2A7 = 10 1010 0111b, B = 0x155 = 01 0101 0101b.
TEST(PixelUnpacking, TakesTenBitsPackedByGigeVision) {
  EXPECT_EQ(unpacked("Mono10Packed", {0xA9, 0x13, 0x55}, 2), (Pixels{0x2A7, 0x155}));
}

// Mono12p: A[7:0], B[3:0] A[11:8], B[11:4]. A = 0x123, B = 0xABC.
TEST(PixelUnpacking, TakesTwelveBitsPackedFromTheLowestBit) {
  EXPECT_EQ(unpacked("Mono12p", {0x23, 0xC1, 0xAB}, 2), (Pixels{0x123, 0xABC}));
}

// Mono10p: five bytes hold A[7:0], B[5:0] A[9:8], C[3:0] B[9:6], D[1:0] C[9:4], D[9:2].
// A = 0x2A7, B = 0x155, C = 0x3F0, D = 0x00F: A7; (15h << 2 | 2) = 56; (0 << 4 | 5) = 05; (3 << 6 | 3F) = FF; 03.
TEST(PixelUnpacking, TakesTenBitsPackedFromTheLowestBit) {
  EXPECT_EQ(unpacked("Mono10p", {0xA7, 0x56, 0x05, 0xFF, 0x03}, 4), (Pixels{0x2A7, 0x155, 0x3F0, 0x00F}));
}

TEST(PixelUnpacking, TakesAnOddNumberOfPixelsFromAnIncompleteGroup) {
  EXPECT_EQ(unpacked("Mono12Packed", {0x12, 0xC3, 0xAB, 0xFF, 0x0E}, 3), (Pixels{0x123, 0xABC, 0xFFE}));
  EXPECT_EQ(unpacked("Mono12p", {0x23, 0xC1, 0xAB, 0xFE, 0x0F}, 3), (Pixels{0x123, 0xABC, 0xFFE}));
  EXPECT_EQ(unpacked("Mono10p", {0xA7, 0x02}, 1), (Pixels{0x2A7}));
}

TEST(PixelUnpacking, KnowsHowManyBytesAnImageTakes) {
  const auto size = [](std::string_view name, std::size_t pixels) {
    return packed_size(*pixel_format_of_name(name), pixels);
  };

  EXPECT_EQ(size("Mono8", 7), 7U);
  EXPECT_EQ(size("Mono14", 7), 14U);
  EXPECT_EQ(size("Mono12Packed", 4), 6U);
  EXPECT_EQ(size("Mono12Packed", 5), 8U);
  EXPECT_EQ(size("Mono10Packed", 4), 6U);
  EXPECT_EQ(size("Mono12p", 5), 8U);  // 60 bits
  EXPECT_EQ(size("Mono10p", 5), 7U);  // 50 bits
}

// A PFNC code carries the bits that a pixel takes in its third byte; GigE's packing of 10 bits takes 12.
TEST(PixelUnpacking, NamesEachFormatByACodeWithItsBits) {
  for (const PixelFormat& format : pixel_formats()) {
    SCOPED_TRACE(format.name);
    constexpr std::size_t kPixels = 8;  // whole groups of every packing

    EXPECT_EQ(8 * packed_size(format, kPixels), kPixels * ((format.code >> 16U) & 0xFFU));
    EXPECT_EQ(pixel_format_of_code(format.code)->name, format.name);
  }
}

TEST(PixelUnpacking, KnowsNoOtherNames) {
  EXPECT_FALSE(pixel_format_of_name("BayerRG8"));
  EXPECT_FALSE(pixel_format_of_name("mono8"));
  EXPECT_FALSE(pixel_format_of_code(0x01080009));
}

}  // namespace
}  // namespace gonio::drivers
