#include "calibration/jobs/detector_map_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

namespace gonio::calibration {
namespace {

constexpr double kBeyond = 6.0;          // of 10^8 good pixels one is lost
constexpr double kLeastNoisy = 4.0;      // times the median variance: twice the noise
constexpr double kDead = 0.5;            // of the median response
constexpr double kRounding2 = 1.0 / 12;  // DN^2: no frame is known better than to a digit
constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();
constexpr std::int64_t kLeastToJudgeNoise = 3;

enum Cause : std::uint8_t { kHot = 1, kNoisy = 2, kDeadPixel = 4, kUneven = 8 };
constexpr std::array<std::pair<Cause, std::string_view>, 4> kCauses{
    {{kHot, "hot"}, {kNoisy, "noisy"}, {kDeadPixel, "dead"}, {kUneven, "uneven"}}};

Error refusal(std::string_view tried, std::string seen, std::string limit) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = std::string(tried),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

struct Spread {
  double median = 0.0;
  double deviation = 0.0;  ///< as a normal distribution's, by the median of the absolute deviations
};

/// The pixels of the square that the aperture counts, and what is wrong with them.
class Pixels {
 public:
  Pixels(const PixelBox& box, const ApertureMask& mask) : box_(box), bad_(box.size(), 0) {
    for (std::size_t k = 0; k < box.size(); ++k) {
      if (distance(k, mask) <= mask.radius_px) counted_.push_back(k);
    }
  }
  [[nodiscard]] const std::vector<std::size_t>& counted() const { return counted_; }
  [[nodiscard]] std::vector<std::size_t> good() const {
    std::vector<std::size_t> all;
    std::ranges::copy_if(counted_, std::back_inserter(all), [this](std::size_t k) { return bad_[k] == 0; });
    return all;
  }
  void mark(std::size_t pixel, Cause cause) { bad_[pixel] = static_cast<std::uint8_t>(bad_[pixel] | cause); }
  [[nodiscard]] double count(std::uint8_t causes) const {
    return static_cast<double>(std::ranges::count_if(counted_, [&](std::size_t k) { return (bad_[k] & causes) != 0; }));
  }
  [[nodiscard]] Spread spread(const std::vector<double>& map) const {
    constexpr double kOfNormal = 1.4826;  // 1 / Phi^-1(3/4)
    std::vector<double> values;
    for (const std::size_t k : counted_) values.push_back(map[k]);
    const double middle = median(values);
    for (double& value : values) value = std::abs(value - middle);
    return {middle, kOfNormal * median(std::move(values))};
  }
  [[nodiscard]] double mean_of_good(const std::vector<double>& map) const {
    const std::vector<std::size_t> pixels = good();
    double sum = 0.0;
    for (const std::size_t k : pixels) sum += map[k];
    return sum / static_cast<double>(pixels.size());
  }
  [[nodiscard]] int x(std::size_t pixel) const {
    return box_.left + static_cast<int>(pixel % static_cast<std::size_t>(box_.columns));
  }
  [[nodiscard]] int y(std::size_t pixel) const {
    return box_.top + static_cast<int>(pixel / static_cast<std::size_t>(box_.columns));
  }
  [[nodiscard]] double distance(std::size_t pixel, const ApertureMask& mask) const {
    return std::hypot(x(pixel) - mask.centre_x_px, y(pixel) - mask.centre_y_px);
  }
  /// The square's values in the place that they have in a frame; `beyond` elsewhere.
  [[nodiscard]] std::vector<float> in_frame(const std::vector<double>& map, float beyond,
                                            const ApertureMask& mask) const {
    constexpr double kEdge = 0.75;  // whatever rounding makes of a pixel on the circle
    std::vector<float> frame(static_cast<std::size_t>(box_.width) * static_cast<std::size_t>(box_.height), beyond);
    for (std::size_t k = 0; k < box_.size(); ++k) {
      if (distance(k, mask) > mask.radius_px + kEdge) continue;
      frame[static_cast<std::size_t>(y(k)) * static_cast<std::size_t>(box_.width) + static_cast<std::size_t>(x(k))] =
          static_cast<float>(map[k]);
    }
    return frame;
  }
  [[nodiscard]] MapFile bad_map(const ApertureMask& mask) const {
    const std::vector<double> causes(bad_.begin(), bad_.end());
    return {.width = box_.width, .height = box_.height, .layers = {in_frame(causes, 0.0F, mask)}, .u = {}};
  }

 private:
  PixelBox box_;
  std::vector<std::size_t> counted_;
  std::vector<std::uint8_t> bad_;
};

// Wilson and Hilferty (1931): the cube root of chi-square / dof is nearly normal. Relative to the median.
double most_of_scatter(double dof) {
  const double middle = 1.0 - 2.0 / (9.0 * dof);
  return std::max(kLeastNoisy, std::pow((middle + kBeyond * std::sqrt(2.0 / (9.0 * dof))) / middle, 3));
}

// The variance of one frame that most pixels have; and which have far more.
double usual_variance(const PixelStack& stack, Pixels& pixels) {
  const auto dof = static_cast<double>(stack.degrees_of_freedom());
  std::vector<double> variances;
  for (const std::size_t k : pixels.counted()) variances.push_back(stack.variance(k));
  const double middle = std::max(kRounding2, median(variances));
  for (const std::size_t k : pixels.counted()) {
    const bool is_judged = stack.degrees_of_freedom() >= kLeastToJudgeNoise;
    if (is_judged && stack.variance(k) > most_of_scatter(dof) * middle) pixels.mark(k, kNoisy);
  }
  return std::max(kRounding2, middle / std::pow(1.0 - 2.0 / (9.0 * dof), 3));  // the median is below the mean
}

void add_value(FoundValues& found, std::string name, std::string unit, double value, double u = 0.0) {
  found.values.push_back({.name = std::move(name), .unit = std::move(unit), .value = value});
  found.covariance.push_back(u * u);  // the diagonal alone, until all are there
}

void finish(FoundValues& found, const Pixels& pixels) {
  add_value(found, "bad_pixels", "1", pixels.count(kHot | kNoisy | kDeadPixel | kUneven));
  for (const auto& [cause, name] : kCauses) add_value(found, "bad_" + std::string(name), "1", pixels.count(cause));
  const std::size_t n = found.values.size();
  std::vector<double> whole(n * n, 0.0);
  for (std::size_t k = 0; k < n; ++k) whole[k * n + k] = found.covariance[k];
  found.covariance = std::move(whole);
  found.note +=
      fmt::format("{} of {} pixels bad", pixels.count(kHot | kNoisy | kDeadPixel | kUneven), pixels.counted().size());
}

/// offset + rate t of each pixel of the square.
struct DarkLine {
  std::vector<double> offset;
  std::vector<double> rate;
  double u_offset = 0.0;
  double u_rate = 0.0;
};

class DarkFit {
 public:
  DarkFit(const std::vector<PixelStack>& darks, Pixels& pixels) : darks_(darks) {
    for (const PixelStack& dark : darks) {
      weights_.push_back(static_cast<double>(dark.frames()) / usual_variance(dark, pixels));
      sum_ += weights_.back();
      mean_t_ += weights_.back() * in_seconds(dark.exposure());
    }
    mean_t_ /= sum_;
    for (std::size_t j = 0; j < darks.size(); ++j) moment_ += weights_[j] * time(j) * time(j);
  }

  [[nodiscard]] bool has_rate() const { return moment_ > 0.0; }
  [[nodiscard]] DarkLine line(const Pixels& pixels) const {
    const std::size_t n = darks_.front().box().size();
    DarkLine line{.offset = std::vector<double>(n, 0.0), .rate = std::vector<double>(n, 0.0)};
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t j = 0; j < darks_.size(); ++j) {
        line.offset[k] += weights_[j] * darks_[j].mean(k) / sum_;
        if (has_rate()) line.rate[k] += weights_[j] * time(j) * darks_[j].mean(k) / moment_;
      }
      line.offset[k] -= mean_t_ * line.rate[k];
    }
    const double birge = std::sqrt(std::max(1.0, chi_square_per_dof(line, pixels)));
    line.u_rate = has_rate() ? birge / std::sqrt(moment_) : 0.0;
    line.u_offset = birge * std::sqrt(1.0 / sum_ + (has_rate() ? mean_t_ * mean_t_ / moment_ : 0.0));
    return line;
  }

 private:
  [[nodiscard]] double time(std::size_t j) const { return in_seconds(darks_[j].exposure()) - mean_t_; }
  [[nodiscard]] double residual(const DarkLine& line, std::size_t j, std::size_t pixel) const {
    return darks_[j].mean(pixel) - line.offset[pixel] - line.rate[pixel] * in_seconds(darks_[j].exposure());
  }
  // What all pixels have in common is the dark level's drift, which the dark visits of each scan take out.
  [[nodiscard]] double chi_square_per_dof(const DarkLine& line, const Pixels& pixels) const {
    constexpr std::size_t kOfALine = 2;
    const std::vector<std::size_t> good = pixels.good();
    if (darks_.size() <= kOfALine || good.empty()) return 0.0;
    const auto n = static_cast<double>(good.size());
    double sum = 0.0;
    for (std::size_t j = 0; j < darks_.size(); ++j) {
      double common = 0.0;
      for (const std::size_t k : good) common += residual(line, j, k) / n;
      for (const std::size_t k : good) sum += weights_[j] * std::pow(residual(line, j, k) - common, 2);
    }
    return sum / (n * static_cast<double>(darks_.size() - kOfALine));
  }

  const std::vector<PixelStack>& darks_;
  std::vector<double> weights_;  ///< of one pixel's mean, 1/DN^2
  double sum_ = 0.0;
  double mean_t_ = 0.0;  ///< s, weighted
  double moment_ = 0.0;  ///< of the times about it
};

Result<void> check_darks(const std::vector<PixelStack>& darks, const ApertureMask& mask) {
  constexpr std::string_view kTried = "make a dark map";
  if (darks.empty()) {
    return failure(refusal(kTried, "no dark frames summed pixel by pixel",
                           "those of a plan with job = \"dark-map\" or \"flat-field\""));
  }
  for (const PixelStack& dark : darks) {
    if (dark.degrees_of_freedom() < 1) {
      return failure(refusal(kTried, fmt::format("{} frames of {} s", dark.frames(), in_seconds(dark.exposure())),
                             "two in one reading at least: their scatter is the map's uncertainty"));
    }
    if (dark.box() != darks.front().box()) return failure(refusal(kTried, "squares of two apertures", "one"));
  }
  if (Pixels(darks.front().box(), mask).counted().empty()) {
    return failure(refusal(kTried, "no pixel inside the aperture", "the aperture that the frames were summed about"));
  }
  return {};
}

void mark_hot(const std::vector<double>& map, double u, Pixels& pixels) {
  const Spread spread = pixels.spread(map);
  const double most = spread.median + kBeyond * std::max(spread.deviation, u);
  for (const std::size_t k : pixels.counted()) {
    if (map[k] > most) pixels.mark(k, kHot);
  }
}

// Dark map and what it says of the pixels; the counts come last.
DetectorMapFit fit_darks(const std::vector<PixelStack>& darks, const ApertureMask& mask, Pixels& pixels) {
  const DarkFit fit(darks, pixels);
  const DarkLine line = fit.line(pixels);
  mark_hot(line.offset, line.u_offset, pixels);
  if (fit.has_rate()) mark_hot(line.rate, line.u_rate, pixels);
  const PixelBox& box = darks.front().box();
  DetectorMapFit maps;
  maps.dark = {.width = box.width,
               .height = box.height,
               .layers = {pixels.in_frame(line.offset, kNotMeasured, mask)},
               .u = {line.u_offset}};
  add_value(maps.found, "dark_offset_dn", "DN", pixels.mean_of_good(line.offset), line.u_offset);
  add_value(maps.found, "dark_offset_spread_dn", "DN", pixels.spread(line.offset).deviation);
  if (fit.has_rate()) {
    maps.dark.layers.push_back(pixels.in_frame(line.rate, kNotMeasured, mask));
    maps.dark.u[1] = line.u_rate;
    add_value(maps.found, "dark_rate_dn_per_s", "DN/s", pixels.mean_of_good(line.rate), line.u_rate);
    add_value(maps.found, "dark_rate_spread_dn_per_s", "DN/s", pixels.spread(line.rate).deviation);
  }
  const auto frames = std::accumulate(darks.begin(), darks.end(), std::int64_t{0},
                                      [](std::int64_t sum, const PixelStack& dark) { return sum + dark.frames(); });
  maps.found.note = fmt::format("{} dark frames at {} exposures{}, ", frames, darks.size(),
                                fit.has_rate() ? "" : " (holds at this one only: no rate)");
  return maps;
}

/// Lit frames less their darks.
struct Net {
  std::vector<double> sum;       ///< DN
  std::vector<double> variance;  ///< of it, DN^2
  std::int64_t frames = 0;
};

Net net_of(const std::vector<PixelStack>& darks, const std::vector<PixelStack>& lit) {
  const std::size_t n = darks.front().box().size();
  Net net{.sum = std::vector<double>(n, 0.0), .variance = std::vector<double>(n, 0.0)};
  for (const PixelStack& light : lit) {
    const auto dark = std::ranges::find(darks, light.exposure(), &PixelStack::exposure);
    if (light.degrees_of_freedom() < 1 || dark == darks.end() || dark->box() != light.box()) continue;
    const auto frames = static_cast<double>(light.frames());
    const double per_dark = frames * frames / static_cast<double>(dark->frames());
    for (std::size_t k = 0; k < n; ++k) {
      net.sum[k] += light.sum(k) - frames * dark->mean(k);
      net.variance[k] += frames * light.variance(k) + per_dark * dark->variance(k);
    }
    net.frames += light.frames();
  }
  return net;
}

// By quarters of the aperture about its centre: pixels differ at random, light does so from one side to the other.
double light_uneven(const std::vector<double>& flat, const Pixels& pixels, const ApertureMask& mask) {
  std::array<double, 4> sums{};
  std::array<double, 4> counts{};
  for (const std::size_t k : pixels.good()) {
    const std::size_t quarter = (pixels.x(k) > mask.centre_x_px ? 1U : 0U) + (pixels.y(k) > mask.centre_y_px ? 2U : 0U);
    sums[quarter] += flat[k];
    counts[quarter] += 1.0;
  }
  double most = 0.0;
  for (std::size_t q = 0; q < sums.size(); ++q) {
    if (counts[q] > 0.0) most = std::max(most, std::abs(sums[q] / counts[q] - 1.0));
  }
  return most;
}

}  // namespace

Result<DetectorMapFit> fit_dark_map(const std::vector<PixelStack>& darks, const ApertureMask& mask) {
  GONIO_TRY(check_darks(darks, mask));
  Pixels pixels(darks.front().box(), mask);
  DetectorMapFit maps = fit_darks(darks, mask, pixels);
  finish(maps.found, pixels);
  maps.bad = pixels.bad_map(mask);
  return maps;
}

Result<DetectorMapFit> fit_flat_field(const std::vector<PixelStack>& darks, const std::vector<PixelStack>& lit,
                                      const ApertureMask& mask) {
  constexpr std::string_view kTried = "make a flat field";
  constexpr const char* kAllBad = "every pixel of the aperture is bad";
  GONIO_TRY(check_darks(darks, mask));
  Pixels pixels(darks.front().box(), mask);
  DetectorMapFit maps = fit_darks(darks, mask, pixels);
  const Net net = net_of(darks, lit);
  if (net.frames == 0) {
    return failure(refusal(kTried,
                           fmt::format("{} lit exposures, none of them twice in a reading and with a dark", lit.size()),
                           "one: raise target_snr, frames are then repeated"));
  }
  const double level = pixels.spread(net.sum).median;
  if (!(level > 0.0)) return failure(refusal(kTried, fmt::format("a net level of {} DN", level), "light"));

  std::vector<double> flat = net.sum;
  for (double& value : flat) value /= level;
  if (pixels.good().empty()) return failure(refusal(kTried, kAllBad, "one good at least"));
  const Spread spread = pixels.spread(flat);
  const double most = kBeyond * std::max(spread.deviation, std::sqrt(pixels.mean_of_good(net.variance)) / level);
  for (const std::size_t k : pixels.counted()) {
    if (flat[k] < kDead) pixels.mark(k, kDeadPixel);
    if (std::abs(flat[k] - 1.0) > most) pixels.mark(k, kUneven);
  }
  if (pixels.good().empty()) return failure(refusal(kTried, kAllBad, "one good at least"));
  const double mean = pixels.mean_of_good(flat);
  for (double& value : flat) value /= mean;
  const double u = std::sqrt(pixels.mean_of_good(net.variance)) / (level * mean);
  maps.flat = MapFile{.width = maps.dark.width,
                      .height = maps.dark.height,
                      .layers = {pixels.in_frame(flat, kNotMeasured, mask)},
                      .u = {u}};
  add_value(maps.found, "flat", "1", 1.0, u);
  add_value(maps.found, "flat_spread", "1", pixels.spread(flat).deviation);
  add_value(maps.found, "light_uneven", "1", light_uneven(flat, pixels, mask));
  maps.found.note += fmt::format("{} lit frames, u of a pixel's flat {:.2g}, ", net.frames, u);
  finish(maps.found, pixels);
  maps.bad = pixels.bad_map(mask);
  return maps;
}

}  // namespace gonio::calibration
