#include "sim/devices/detector_noise.h"

#include <algorithm>
#include <cmath>

#include "sim/devices/pixel_pattern.h"
#include "sim/optics/speckle_pattern.h"
#include "sim/scene/chance.h"

namespace gonio::sim {
namespace {

// One pixel's chance, for a given exposure.
class PixelModel {
 public:
  PixelModel(const DetectorSpec& spec, const Exposure& exposure)
      : spec_(spec),
        exposure_(exposure),
        offset_dn_(spec.offset_dn + exposure.offset_shift_dn),
        dn_per_electron_(std::pow(10.0, exposure.gain_db / 20.0) / spec.electrons_per_dn) {}

  [[nodiscard]] double electrons(double lit) const {
    return lit * exposure_.light_electrons + exposure_.dark_electrons;
  }
  [[nodiscard]] double mean_dn() const { return offset_dn_ + dn_per_electron_ * electrons(1.0); }
  // Cumulants of a fully lit pixel: Poisson, read noise, and rounding to whole DN (variance 1/12, fourth cumulant
  // -1/120).
  [[nodiscard]] double cumulant2() const {
    const double gain = std::pow(10.0, exposure_.gain_db / 20.0);
    const double read = spec_.read_noise_dn * gain;
    return electrons(1.0) * dn_per_electron_ * dn_per_electron_ + read * read + 1.0 / 12.0;
  }
  [[nodiscard]] double cumulant3() const { return electrons(1.0) * std::pow(dn_per_electron_, 3); }
  [[nodiscard]] double cumulant4() const { return electrons(1.0) * std::pow(dn_per_electron_, 4) - 1.0 / 120.0; }

  [[nodiscard]] double draw(Chance& chance, double lit, bool is_bad) const {
    const double read = spec_.read_noise_dn == 0.0 ? 0.0 : spec_.read_noise_dn * chance.normal();
    const double signal =
        chance.poisson(electrons(lit)) * dn_per_electron_ + read * dn_per_electron_ * spec_.electrons_per_dn;
    const double most = is_bad ? std::floor(PixelPattern::kEarlyFull * spec_.full_scale_dn()) : spec_.full_scale_dn();
    return std::clamp(std::round(offset_dn_ + signal), 0.0, most);
  }

 private:
  const DetectorSpec& spec_;
  const Exposure& exposure_;
  double offset_dn_;
  double dn_per_electron_;
};

double lit_share(const DetectorSpec& spec, double distance_px) {
  constexpr double kEdgePx = 2.0;
  return std::clamp(1.0 - (distance_px - spec.spot_radius_px) / kEdgePx, 0.0, 1.0);
}

double distance(const Aperture& a, int x, int y) {
  return std::hypot(x - a.centre_x_px, y - a.centre_y_px);
}

// The aperture's pixels of one row: those of a chord, [first, last], none when last < first.
struct Chord {
  int first = 0;
  int last = -1;
};

Chord chord(const Aperture& a, int width_px, int y) {
  const double dy = y - a.centre_y_px;
  const double half2 = a.radius_px * a.radius_px - dy * dy;
  if (half2 < 0.0) return {};
  const double half = std::sqrt(half2);
  return {.first = static_cast<int>(std::max(0.0, std::ceil(a.centre_x_px - half))),
          .last = static_cast<int>(std::min(width_px - 1.0, std::floor(a.centre_x_px + half)))};
}

std::uint32_t pixels_inside(const DetectorSpec& spec) {
  const Aperture a = aperture_of(spec);
  int n = 0;
  for (int y = 0; y < spec.height_px; ++y) {
    const Chord row = chord(a, spec.width_px, y);
    n += std::max(0, row.last - row.first + 1);
  }
  return static_cast<std::uint32_t>(n);
}

std::vector<double> drawn_pixels(const DetectorSpec& spec, const PixelModel& pixel, const SpecklePattern& speckle,
                                 const PixelPattern& pattern, Chance& chance) {
  const Aperture a = aperture_of(spec);
  std::vector<double> values;
  for (int y = 0; y < spec.height_px; ++y) {
    const Chord row = chord(a, spec.width_px, y);
    for (int x = row.first; x <= row.last; ++x) {
      values.push_back(pixel.draw(chance, speckle(x, y) * pattern.response(x, y), pattern.is_bad(x, y)));
    }
  }
  return values;
}

RegionStatistics statistics_of(const std::vector<double>& values, double full_scale_dn) {
  const double n = static_cast<double>(values.size());
  RegionStatistics s{.n = static_cast<std::uint32_t>(values.size())};
  for (const double v : values) {
    s.mean += v / n;
    s.saturated += v >= full_scale_dn ? 1U : 0U;
  }
  for (const double v : values) {
    const double d = v - s.mean;
    s.m2 += d * d / n;
    s.m3 += d * d * d / n;
    s.m4 += d * d * d * d / n;
  }
  return s;
}

}  // namespace

Aperture aperture_of(const DetectorSpec& spec) {
  return {.centre_x_px = 0.5 * (spec.width_px - 1),
          .centre_y_px = 0.5 * (spec.height_px - 1),
          .radius_px = spec.aperture_radius_px};
}

std::vector<std::uint16_t> render_frame(const DetectorSpec& spec, const Exposure& exposure, std::uint64_t seed) {
  const PixelModel pixel(spec, exposure);
  const Aperture middle = aperture_of(spec);
  const SpecklePattern speckle(spec.speckle, spec.width_px, spec.height_px, seed, exposure.place);
  const PixelPattern pattern(spec, seed);
  Chance chance(seed, Purpose::Pixels, exposure.number);
  std::vector<std::uint16_t> frame;
  frame.reserve(static_cast<std::size_t>(spec.width_px) * static_cast<std::size_t>(spec.height_px));
  for (int y = 0; y < spec.height_px; ++y) {
    for (int x = 0; x < spec.width_px; ++x) {
      const double lit = lit_share(spec, distance(middle, x, y)) * speckle(x, y) * pattern.response(x, y);
      frame.push_back(static_cast<std::uint16_t>(pixel.draw(chance, lit, pattern.is_bad(x, y))));
    }
  }
  return frame;
}

RegionStatistics draw_region(const DetectorSpec& spec, const Exposure& exposure, std::uint64_t seed) {
  constexpr double kFarFromClipping = 6.0;  // standard deviations: one pixel in 1e9
  constexpr double kFinelyRounded = 0.6;    // standard deviation in DN above which rounding is plain noise to 1e-3
  const PixelModel pixel(spec, exposure);
  Chance chance(seed, Purpose::Pixels, exposure.number);
  const double n = pixels_inside(spec);
  const double sigma = std::sqrt(pixel.cumulant2());
  const double headroom = std::min(pixel.mean_dn(), spec.full_scale_dn() - pixel.mean_dn());
  const PixelPattern pattern(spec, seed);
  if (headroom < kFarFromClipping * sigma || sigma < kFinelyRounded || spec.speckle.contrast != 0.0 ||
      !pattern.is_even()) {
    const SpecklePattern speckle(spec.speckle, spec.width_px, spec.height_px, seed, exposure.place);
    return statistics_of(drawn_pixels(spec, pixel, speckle, pattern, chance), spec.full_scale_dn());
  }
  // Mean and variance of nearly normal pixels are independent; skewness and kurtosis scatter by 6/n and 24/n.
  RegionStatistics s{.n = static_cast<std::uint32_t>(n)};
  s.mean = pixel.mean_dn() + sigma / std::sqrt(n) * chance.normal();
  s.m2 = pixel.cumulant2() * chance.chi_squared(n - 1.0) / n;
  const double skewness = pixel.cumulant3() / std::pow(sigma, 3) + std::sqrt(6.0 / n) * chance.normal();
  const double kurtosis = 3.0 + pixel.cumulant4() / std::pow(sigma, 4) + std::sqrt(24.0 / n) * chance.normal();
  s.m3 = skewness * std::pow(s.m2, 1.5);
  s.m4 = std::max(kurtosis, 1.0) * s.m2 * s.m2;
  return s;
}

double after_nonlinearity(const DetectorSpec& spec, double light_electrons, double nonlinearity) {
  return light_electrons * (1.0 + nonlinearity * light_electrons / (spec.full_scale_dn() * spec.electrons_per_dn));
}

}  // namespace gonio::sim
