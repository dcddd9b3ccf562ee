// The daemon's description of the radiometers.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sim/scene/papers.h"
#include "sim/wires/usbtmc_function.h"

namespace gonio::sim {
namespace {

// An exponential with the meter's time constant has died away to less than a millionth after so many.
constexpr double kSettleTimes = 14.0;

std::string device_lines(const Scene& scene, const RadiometerSpec& spec) {
  return fmt::format(
      "kind = \"usbtmc\"\nvendor_id = {}\nproduct_id = {}\nserial = \"{}\"\naverages = {}\nsample_time_s = {:.6g}\n"
      "settle_s = {:.6g}\n",
      UsbtmcFunction::kVendor, UsbtmcFunction::kProduct, spec.serial, spec.averages, spec.average_s / scene.time_scale,
      kSettleTimes * spec.settle_s / scene.time_scale);
}

}  // namespace

const RadiometerSpec* radiometer_at(const Scene& scene, RadiometerPlace place) {
  const auto found = std::ranges::find(scene.radiometers, place, &RadiometerSpec::place);
  return found == scene.radiometers.end() ? nullptr : &*found;
}

std::string radiometer_detector_section(const Scene& scene) {
  const RadiometerSpec* spec = radiometer_at(scene, RadiometerPlace::Detector);
  if (spec == nullptr) return {};
  constexpr double kZeroPatience = 5.0;
  std::vector<double> ranges;
  for (const RadiometerRange& range : spec->ranges) ranges.push_back(range.full_scale_w);
  return fmt::format(
      "\n[detector]\n{}ranges_w = [{}]\nsamples = {}\nreadings_at_most = {}\nzero = true\nzero_time_s = {:.6g}\n"
      "\n[detector.model]\nnoise = {:.6g}\nu_linearity = 0.0\nu_range = {:.6g}\nu_zero = 0.0\n",
      device_lines(scene, *spec), fmt::join(ranges, ", "), spec->samples, spec->readings_at_most,
      2.0 * spec->zero_s / scene.time_scale + kZeroPatience, spec->ranges.front().noise, spec->u_range);
}

// In the range that holds the lamp with room for its drift.
std::string radiometer_monitor_section(const Scene& scene) {
  const RadiometerSpec* spec = radiometer_at(scene, RadiometerPlace::Monitor);
  if (spec == nullptr) return {};
  const double wanted = 1.1 * scene.lamp.power * spec->watts;
  const auto fits = [&](const RadiometerRange& range) { return range.full_scale_w >= wanted; };
  const auto found = std::ranges::find_if(spec->ranges, fits);
  const RadiometerRange& range = found == spec->ranges.end() ? spec->ranges.back() : *found;
  return fmt::format("\n[monitor]\n{}wavelength_nm = {:.10g}\nrange_w = {:g}\nu_window = {:.6g}\n",
                     device_lines(scene, *spec), in_nanometres(spec->lamp_wavelength), range.full_scale_w,
                     spec->u_window);
}

}  // namespace gonio::sim
