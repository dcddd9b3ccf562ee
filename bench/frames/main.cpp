// Frame reduction beside memcpy of as many bytes as it must read (pixels, and maps where there are any), in one run, in
// turns, of frames that no cache holds any more;
// and its error beside the same sums in long double.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "calibration/frame_reducer.h"

namespace gonio::bench {
namespace {

using calibration::DetectorMaps;
using calibration::FrameReducer;
using calibration::ReducedFrame;

constexpr std::uint64_t kSeed = 1;
constexpr int kRounds = 15;
constexpr std::size_t kBeyondCaches = 100'000'000;
constexpr double kGoal = 0.5;  // of memcpy
constexpr double kExposure_s = 0.25;

enum class Maps : std::uint8_t { None, Flat, Curved };

struct Case {
  std::string name;
  int side = 0;
  int bits = 12;
  Maps maps = Maps::None;
};

struct Frame {
  std::vector<std::uint16_t> pixels;
  DetectorMaps maps;
};

// A sample half as bright as the scale, with shot noise; each twentieth map value another.
Frame frame_of(const Case& c) {
  std::mt19937_64 chance(kSeed);
  const double full_scale = std::pow(2.0, c.bits) - 1.0;
  std::normal_distribution<double> light(0.5 * full_scale, 0.01 * full_scale);
  std::normal_distribution<float> response(1.0F, 0.02F);
  Frame frame;
  frame.maps.width = frame.maps.height = c.side;
  const std::size_t n = static_cast<std::size_t>(c.side) * static_cast<std::size_t>(c.side);
  for (std::size_t k = 0; k < n; ++k) {
    frame.pixels.push_back(static_cast<std::uint16_t>(std::clamp(light(chance), 0.0, full_scale - 1.0)));
    if (c.maps == Maps::None) continue;
    frame.maps.dark_offset_dn.push_back(64.0F + response(chance));
    frame.maps.dark_rate_dn_per_s.push_back(response(chance));
    frame.maps.flat.push_back(response(chance));
    frame.maps.bad.push_back(chance() % 1000 == 0 ? 1 : 0);
    if (c.maps == Maps::Curved) frame.maps.linearity_1.push_back(0.01F * response(chance));
    if (c.maps == Maps::Curved) frame.maps.linearity_2.push_back(0.001F * response(chance));
  }
  return frame;
}

calibration::ApertureMask circle(int side) {
  return {.centre_x_px = 0.5 * (side - 1), .centre_y_px = 0.5 * (side - 1), .radius_px = 0.5 * (side - 1)};
}

struct LongSums {
  long double n = 0.0L;
  long double mean = 0.0L;
  long double m4 = 0.0L;
  long double reduced = 0.0L;
};

long double reduced_pixel(const Case& c, const Frame& frame, std::size_t k) {
  const DetectorMaps& maps = frame.maps;
  const long double net = frame.pixels[k] - (static_cast<long double>(maps.dark_offset_dn[k]) +
                                             static_cast<long double>(kExposure_s) * maps.dark_rate_dn_per_s[k]);
  if (c.maps != Maps::Curved) return net / maps.flat[k];
  const long double x = net / (std::pow(2.0L, c.bits) - 1.0L);
  return net * (1.0L + maps.linearity_1[k] * x + maps.linearity_2[k] * x * x) / maps.flat[k];
}

LongSums in_long_double(const Case& c, const Frame& frame) {
  const calibration::ApertureMask mask = circle(c.side);
  LongSums sums;
  std::vector<std::size_t> inside;
  for (std::size_t k = 0; k < frame.pixels.size(); ++k) {
    const auto side = static_cast<std::size_t>(c.side);
    const double dx = static_cast<double>(k % side) - mask.centre_x_px;
    const double dy = static_cast<double>(k / side) - mask.centre_y_px;
    const bool is_bad = !frame.maps.bad.empty() && frame.maps.bad[k] != 0;
    if (!is_bad && dx * dx + dy * dy <= mask.radius_px * mask.radius_px) inside.push_back(k);
  }
  sums.n = static_cast<long double>(inside.size());
  for (const std::size_t k : inside) {
    sums.mean += frame.pixels[k] / sums.n;
    if (c.maps != Maps::None) sums.reduced += reduced_pixel(c, frame, k) / sums.n;
  }
  for (const std::size_t k : inside) sums.m4 += std::pow(frame.pixels[k] - sums.mean, 4) / sums.n;
  return sums;
}

// Of this thread's processor: wall time would measure what else the machine does.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Work>
double seconds_of(std::size_t repeats, Work work) {
  const double begin = processor_seconds();
  for (std::size_t k = 0; k < repeats; ++k) work(k);
  return (processor_seconds() - begin) / static_cast<double>(repeats);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

double relative(double value, long double truth) {
  return truth == 0.0L ? 0.0 : std::abs(static_cast<double>((value - truth) / truth));
}

// One line of the table; whether the goal is met.
bool run(const Case& c) {
  const Frame frame = frame_of(c);
  const auto full_scale = static_cast<std::uint16_t>((1U << static_cast<unsigned>(c.bits)) - 1U);
  const auto maps = c.maps == Maps::None ? std::nullopt : std::optional(frame.maps);
  const auto reducer = FrameReducer::prepare(c.side, c.side, full_scale, circle(c.side), maps);
  if (!reducer) {
    fmt::print("{}: {}\n", c.name, describe(reducer.error()));
    return false;
  }
  const std::size_t bytes = reducer->bytes_read();
  // As many frames as no cache holds, one after the other: a frame that came off a wire was written long ago.
  const std::size_t frames = kBeyondCaches / bytes + 2;
  const std::vector<std::vector<std::uint16_t>> pixels(frames, frame.pixels);
  const std::vector<std::vector<unsigned char>> from(frames, std::vector<unsigned char>(bytes, 1));
  std::vector<unsigned char> to(bytes, 0);
  ReducedFrame reduced;
  std::vector<double> reduce_s, copy_s, ratios;
  for (int round = 0; round < kRounds; ++round) {
    reduce_s.push_back(
        seconds_of(frames, [&](std::size_t k) { reduced = *reducer->reduce(pixels[k], kExposure_s, 0.0); }));
    copy_s.push_back(seconds_of(frames, [&](std::size_t k) {
      std::memcpy(to.data(), from[k].data(), bytes);
      asm volatile("" : : "r"(to.data()) : "memory");  // the copy is not to be left out
    }));
    ratios.push_back(copy_s.back() / reduce_s.back());
  }
  const LongSums truth = in_long_double(c, frame);
  const double reduced_error = reduced.reduced ? relative(reduced.reduced->mean_dn, truth.reduced) : 0.0;
  const double gigabytes = static_cast<double>(bytes) * 1e-9;
  fmt::print("| {} | {:.2f} | {:.1f} | {:.1f} | {:.2f} | {:.1e} | {:.1e} | {:.1e} |\n", c.name, gigabytes * 1e3,
             gigabytes / median(reduce_s), gigabytes / median(copy_s), median(ratios),
             relative(reduced.raw.mean, truth.mean), relative(reduced.raw.m4, truth.m4), reduced_error);
  return median(ratios) >= kGoal;
}

}  // namespace
}  // namespace gonio::bench

int main() {
  using gonio::bench::Maps;
  fmt::print("seed {}; medians of {} rounds, in turns; goal: {} of memcpy\n\n", gonio::bench::kSeed,
             gonio::bench::kRounds, gonio::bench::kGoal);
  fmt::print(
      "| frame | read [MB] | reduction [GB/s] | memcpy [GB/s] | ratio | error of mean | of m4 | of reduced mean |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  int met = 0;
  const std::vector<gonio::bench::Case> cases{{"512^2, 12 bits, no maps", 512, 12, Maps::None},
                                              {"2048^2, 12 bits, no maps", 2048, 12, Maps::None},
                                              {"2048^2, 16 bits, no maps", 2048, 16, Maps::None},
                                              {"512^2, 12 bits, dark and flat", 512, 12, Maps::Flat},
                                              {"2048^2, 12 bits, dark and flat", 2048, 12, Maps::Flat},
                                              {"2048^2, 12 bits, and linearity", 2048, 12, Maps::Curved},
                                              {"2048^2, 16 bits, and linearity", 2048, 16, Maps::Curved}};
  for (const auto& one : cases) met += gonio::bench::run(one) ? 1 : 0;
  fmt::print("\n{} of {} reach the goal\n", met, cases.size());
  return met == static_cast<int>(cases.size()) ? 0 : 1;
}
