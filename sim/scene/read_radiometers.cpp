#include <fmt/format.h>
#include <array>
#include <string_view>

#include "sim/scene/read_sections.h"

namespace gonio::sim {
namespace {

constexpr NumberRange kMeterPositive{.least = 1e-15};
constexpr NumberRange kMeterShare{.least = 0.0, .most = 1.0};
constexpr NumberRange kMeterTime{.least = 0.0, .most = 600.0, .unit = "s"};

// The ranges as decades or whatever the meter has; noise and offset are the same part of each.
void read_ranges(TomlReader& t, RadiometerSpec& spec) {
  const double noise = t.number_or("noise", 0.0, kMeterShare);
  const double offset = t.number_or("offset", 0.0, {.least = -1.0, .most = 1.0});
  spec.ranges.clear();
  for (const double full_scale : t.numbers("ranges_w", kMeterPositive)) {
    if (!spec.ranges.empty() && full_scale <= spec.ranges.back().full_scale_w) {
      t.fail("ranges_w", ErrorCode::InvalidInput, fmt::format("{} W after a larger one", full_scale),
             "ascending ranges");
    }
    spec.ranges.push_back({.full_scale_w = full_scale, .noise = noise, .offset = offset});
  }
}

RadiometerSpec read_radiometer(TomlReader& t) {
  constexpr std::array<std::string_view, 2> kRoles{"detector", "monitor"};
  RadiometerSpec spec = quiet_radiometer();
  spec.place = static_cast<RadiometerPlace>(t.choice("role", kRoles));
  spec.serial = t.text("serial");
  spec.watts = t.number_or("watts", spec.watts, kMeterPositive);
  spec.lamp_wavelength = nanometres(t.number_or("lamp_wavelength_nm", in_nanometres(spec.lamp_wavelength),
                                                {.least = 400.0, .most = 1100.0, .unit = "nm"}));
  read_ranges(t, spec);
  spec.u_range = t.number_or("u_range", 0.0, kMeterShare);
  spec.average_s = t.number_or("average_s", spec.average_s, {.least = 1e-5, .most = 10.0, .unit = "s"});
  spec.settle_s = t.number_or("settle_s", spec.settle_s, kMeterTime);
  spec.zero_s = t.number_or("zero_s", spec.zero_s, {.least = 1e-3, .most = 60.0, .unit = "s"});
  spec.u_window = t.number_or("u_window", 0.0, kMeterShare);
  spec.averages = static_cast<int>(t.integer_or("averages", spec.averages, 1, 10000));
  spec.samples = static_cast<int>(t.integer_or("samples", spec.samples, 2, 10000));
  spec.readings_at_most = static_cast<int>(t.integer_or("readings_at_most", spec.readings_at_most, 1, 10000));
  return spec;
}

}  // namespace

void read_radiometers(TomlReader& root, Scene& scene) {
  for (TomlReader& t : root.tables("radiometers")) {
    const RadiometerSpec spec = read_radiometer(t);
    for (const RadiometerSpec& other : scene.radiometers) {
      if (other.place == spec.place) t.fail("role", ErrorCode::InvalidInput, "this role is taken", "one meter a role");
      if (other.serial == spec.serial)
        t.fail("serial", ErrorCode::InvalidInput, "\"" + spec.serial + "\" stands here twice", "a serial number each");
    }
    scene.radiometers.push_back(spec);
  }
}

}  // namespace gonio::sim
