// Frames of odd sizes, and masks anywhere: the reduction beside one in long double, pixel by pixel.
#include <cmath>
#include <vector>

#include "calibration/frame_reducer.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

using calibration::ApertureMask;
using calibration::FrameReducer;

constexpr std::size_t kLongestSide = 80;

struct Moments {
  std::uint32_t n = 0;
  std::uint32_t saturated = 0;
  long double mean = 0.0L;
  long double m2 = 0.0L;
  long double m4 = 0.0L;
};

template <class Visit>
void for_each_inside(const std::vector<std::uint16_t>& pixels, int width, int height, const ApertureMask& mask,
                     Visit visit) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double dx = x - mask.centre_x_px;
      const double dy = y - mask.centre_y_px;
      if (dx * dx + dy * dy <= mask.radius_px * mask.radius_px)
        visit(pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]);
    }
  }
}

Moments plain_moments(const std::vector<std::uint16_t>& pixels, int width, int height, std::uint16_t full_scale,
                      const ApertureMask& mask) {
  Moments m;
  for_each_inside(pixels, width, height, mask, [&](std::uint16_t pixel) {
    ++m.n;
    m.saturated += pixel >= full_scale ? 1U : 0U;
    m.mean += pixel;
  });
  if (m.n == 0) return m;
  m.mean /= m.n;
  for_each_inside(pixels, width, height, mask, [&](std::uint16_t pixel) {
    const long double d2 = (pixel - m.mean) * (pixel - m.mean);
    m.m2 += d2 / m.n;
    m.m4 += d2 * d2 / m.n;
  });
  return m;
}

bool is_near(double value, long double expected, long double scale) {
  return std::abs(value - expected) <= 1e-10L * scale;
}

// Quarters of a pixel from -8 on, so that a circle often touches centres; the rest of the bytes are any double.
double length_of(ByteSource& source) {
  const std::uint16_t word = source.word();
  if (word < 0xF000) return (word % 0x200) / 4.0 - 8.0;
  return std::ldexp(static_cast<double>(word) - 0xF800, word % 2048 - 1000);
}

std::vector<std::uint16_t> pixels_of(ByteSource& source, std::size_t count) {
  std::vector<std::uint16_t> pixels(count);
  for (auto& pixel : pixels) pixel = source.word();
  return pixels;
}

}  // namespace

void frame(Bytes input) {
  ByteSource source(input);
  const int width = static_cast<int>(source.byte() % (kLongestSide + 2)) - 1;
  const int height = static_cast<int>(source.byte() % (kLongestSide + 2)) - 1;
  const std::uint16_t full_scale = source.word();
  const ApertureMask mask{length_of(source), length_of(source), length_of(source)};
  const auto whole = static_cast<std::size_t>(std::max(width, 0)) * static_cast<std::size_t>(std::max(height, 0));
  const std::size_t missing = source.byte() == 0xFF ? source.byte() : 0;
  const auto pixels = pixels_of(source, whole - std::min(whole, missing));

  const auto reducer = FrameReducer::prepare(width, height, full_scale, mask);
  if (!reducer) {
    hold_device_error(reducer.error());
    return;
  }
  const auto taken = reducer->reduce(pixels, 0.001, 0.0);
  if (!taken) {
    hold_device_error(taken.error());
    hold(pixels.size() != whole, "a whole frame is reduced");
    return;
  }
  hold(width > 0 && height > 0 && pixels.size() == whole, "a frame that is reduced is whole");
  hold(!taken->reduced && taken->bad == 0, "without maps there is no reduced mean, and no pixel is bad");
  const calibration::RegionMoments* reduced = &taken->raw;
  const Moments plain = plain_moments(pixels, width, height, full_scale, mask);
  hold(reduced->n > 0 && reduced->saturated <= reduced->n, "no more pixels are saturated than there are");
  hold(reduced->n <= whole && std::isfinite(reduced->m3), "a region lies in its frame");
  // Where a centre lies on the circle itself, rounding may count it or not.
  if (reduced->n != plain.n) return;
  hold(reduced->saturated == plain.saturated, "saturated pixels are counted");
  const long double scale2 = plain.m2 + plain.mean * plain.mean;
  hold(is_near(reduced->mean, plain.mean, plain.mean + 1.0L), "the mean is the plain one");
  hold(is_near(reduced->m2, plain.m2, scale2 + 1.0L), "the second moment is the plain one");
  hold(is_near(reduced->m4, plain.m4, scale2 * scale2 + 1.0L), "the fourth moment is the plain one");
}

}  // namespace gonio::fuzz
