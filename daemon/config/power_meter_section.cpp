#include "daemon/config/power_meter_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace gonio::daemon {
namespace {

constexpr NumberRange kMeterShare{.least = 0.0, .most = 1.0};
constexpr NumberRange kMeterPower{.least = 1e-15, .most = 1e6, .unit = "W"};
constexpr NumberRange kMeterWavelength{.least = 100.0, .most = 20000.0, .unit = "nm"};
constexpr int kMostAverages = 100'000;

PowerMeterConfig read_meter(TomlReader& table) {
  PowerMeterConfig meter;
  meter.vendor_id = static_cast<std::uint16_t>(table.integer("vendor_id", 0, UINT16_MAX));
  meter.product_id = static_cast<std::uint16_t>(table.integer("product_id", 0, UINT16_MAX));
  meter.serial = table.text("serial");
  meter.averages = static_cast<int>(table.integer_or("averages", 1, 1, kMostAverages));
  meter.sample_time = seconds(table.number("sample_time_s", {.least = 1e-6, .most = 60.0, .unit = "s"}));
  meter.settle = seconds(table.number("settle_s", {.least = 0.0, .most = 600.0, .unit = "s"}));
  return meter;
}

std::vector<double> read_ranges(TomlReader& table) {
  std::vector<double> ranges = table.numbers("ranges_w", kMeterPower);
  std::ranges::sort(ranges, std::greater<>());
  if (std::ranges::adjacent_find(ranges) != ranges.end()) {
    table.fail("ranges_w", ErrorCode::InvalidInput, "a range stands here twice", "each range once");
  }
  return ranges;
}

calibration::DetectorModel read_power_model(TomlReader table) {
  calibration::DetectorModel model;
  model.full_scale_dn = 1.0;
  model.u_linearity = table.number("u_linearity", kMeterShare);
  model.power = calibration::PowerModel{.noise = table.number("noise", {.least = 1e-12, .most = 1.0}),
                                        .u_range = table.number("u_range", kMeterShare),
                                        .u_zero = table.number("u_zero", kMeterShare)};
  return model;
}

}  // namespace

int PowerMonitorConfig::samples_in(Duration window) const {
  const double one = in_seconds(meter.averages * meter.sample_time);
  return static_cast<int>(
      std::clamp(std::ceil(in_seconds(window) / one), double{kFewestSamples}, double{kMostSamples}));
}

void read_power_detector(TomlReader& table, Instrument& instrument) {
  PowerDetectorConfig power;
  power.meter = read_meter(table);
  power.ranges_w = read_ranges(table);
  power.samples = static_cast<int>(table.integer("samples", 2, 100'000));
  power.zero = table.flag_or("zero", true);
  power.zero_time = seconds(table.number_or("zero_time_s", 30.0, {.least = 0.1, .most = 600.0, .unit = "s"}));
  DetectorConfig& detector = instrument.detector;
  detector.serial = power.meter.serial;
  detector.frames_at_most = static_cast<int>(table.integer("readings_at_most", 1, 100'000));
  detector.shortest_exposure = power.reading_time();
  detector.longest_exposure = power.reading_time();
  detector.power = std::move(power);
  instrument.model.detector = read_power_model(table.table("model"));
}

void read_monitor(TomlReader& root, Instrument& instrument) {
  constexpr std::array<std::string_view, 2> kKinds{"stage", "usbtmc"};
  std::optional<TomlReader> table = root.optional_table("monitor");
  const bool is_meter = table && kKinds[table->choice("kind", kKinds)] == "usbtmc";
  if (!is_meter) {
    if (!instrument.detector.power) return;
    TomlReader& place = table ? *table : root;
    place.fail(table ? "kind" : "monitor", ErrorCode::InvalidInput,
               "the stage's monitor is gated by a camera's exposure",
               "[monitor] kind = \"usbtmc\" beside a radiometer as detector");
    return;
  }
  PowerMonitorConfig monitor;
  monitor.meter = read_meter(*table);
  monitor.wavelength = nanometres(table->number("wavelength_nm", kMeterWavelength));
  monitor.range_w = table->number("range_w", kMeterPower);
  instrument.model.detector.u_monitor_window = table->number_or("u_window", 0.0, kMeterShare);
  if (instrument.detector.power && instrument.detector.power->meter.serial == monitor.meter.serial) {
    table->fail("serial", ErrorCode::InvalidInput, fmt::format("\"{}\" is the detector's", monitor.meter.serial),
                "a meter of its own");
  }
  instrument.monitor = std::move(monitor);
}

}  // namespace gonio::daemon
