// Samples a second of the radiometer's driver through libusb, beside bare libusb loops with the same transfers, on a
// USB that is emulated below libc. In turns, so that a machine that slows down slows all of them. Usage:
// bench_radiometer [ROUNDS]
#include <fmt/format.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include "drivers/links/libusb_usbtmc_link.h"
#include "drivers/radiometer/scpi_radiometer.h"
#include "protocol/usbtmc/message.h"
#include "reflectance/surface/make_surface.h"
#include "sim/wires/usb_bus.h"

namespace {

using namespace gonio;
using sim::UsbtmcFunction;

constexpr int kSamples = 500;  // of a round
constexpr unsigned kTimeoutMs = 10000;
constexpr double kLeastRatio = 0.9;

sim::Scene scene() {
  sim::Scene scene;
  scene.sample.push_back({.surface = *reflectance::make_surface("lambertian", {{"rho", 0.5}}), .weight = 1.0});
  scene.reference.certificate.push_back({.wavelength = nanometres(568.0), .reflectance = 0.99, .uncertainty = 0.005});
  scene.detector.electrons_per_s = 1.0;
  scene.stage.registers = stage::own_register_map();
  return scene;
}

sim::RadiometerSpec monitor() {
  sim::RadiometerSpec spec = sim::quiet_radiometer();
  spec.place = sim::RadiometerPlace::Monitor;
  spec.average_s = 1e-6;  // the meter itself takes no time worth speaking of
  return spec;
}

template <class Run>
double per_second(Run run) {
  const auto start = std::chrono::steady_clock::now();
  if (!run()) return 0.0;
  return kSamples / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double driver_rate() {
  const SystemClock clock;
  drivers::LibusbUsbtmcLink link(
      {.vendor_id = UsbtmcFunction::kVendor, .product_id = UsbtmcFunction::kProduct, .serial = "SIM-PM-01"});
  drivers::ScpiRadiometer driver(link,
                                 {.serial = "SIM-PM-01",
                                  .settings = {.wavelength = nanometres(568.0), .range_w = 1e-2, .samples = kSamples},
                                  .range_settle = Duration::zero()},
                                 clock);
  if (!driver.ensure_open()) return 0.0;
  return per_second([&] {
    if (!driver.trigger()) return false;
    const auto taken = driver.collect(std::chrono::minutes(5));
    return taken && taken->has_value();
  });
}

// One sample by hand; false when a transfer failed.
bool bare_sample(libusb_device_handle* handle, usbtmc::TagSequence& tags, bool with_status) {
  static constexpr std::array<std::uint8_t, 6> kRead{'R', 'E', 'A', 'D', '?', '\n'};
  auto out = usbtmc::dev_dep_msg_out(tags.next(), kRead, true);
  auto request = usbtmc::request_dev_dep_msg_in(tags.next(), 1024);
  std::array<std::uint8_t, 2048> reply{};
  std::array<std::uint8_t, 3> status{};
  int done = 0;
  return libusb_bulk_transfer(handle, UsbtmcFunction::kBulkOut, out.data(), static_cast<int>(out.size()), &done,
                              kTimeoutMs) == 0 &&
         libusb_bulk_transfer(handle, UsbtmcFunction::kBulkOut, request.data(), static_cast<int>(request.size()), &done,
                              kTimeoutMs) == 0 &&
         libusb_bulk_transfer(handle, UsbtmcFunction::kBulkIn, reply.data(), static_cast<int>(reply.size()), &done,
                              kTimeoutMs) == 0 &&
         (!with_status || libusb_control_transfer(handle, 0xA1, 128, 2, 0, status.data(), 3, kTimeoutMs) == 3);
}

double bare_rate(bool with_status) {
  libusb_context* made = nullptr;
  if (libusb_init(&made) != 0) return 0.0;
  const std::unique_ptr<libusb_context, void (*)(libusb_context*)> context(made, libusb_exit);
  const std::unique_ptr<libusb_device_handle, void (*)(libusb_device_handle*)> handle(
      libusb_open_device_with_vid_pid(made, UsbtmcFunction::kVendor, UsbtmcFunction::kProduct), libusb_close);
  if (handle == nullptr || libusb_claim_interface(handle.get(), 0) != 0) return 0.0;
  usbtmc::TagSequence tags;
  return per_second([&] {
    for (int k = 0; k < kSamples; ++k) {
      if (!bare_sample(handle.get(), tags, with_status)) return false;
    }
    return true;
  });
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  const SystemClock clock;
  sim::LiveInstrument instrument(scene(), {}, clock);
  sim::LiveRadiometer meter(instrument, monitor(), false);
  sim::UsbBus bus(meter);
  if (!bus.plug()) return EXIT_FAILURE;
  std::vector<double> ours, same, least, ratios;
  for (int k = 0; k < rounds; ++k) {
    same.push_back(bare_rate(true));
    ours.push_back(driver_rate());
    least.push_back(bare_rate(false));
    ratios.push_back(ours.back() / same.back());
  }
  fmt::print("samples a second of a radiometer, medians of {} rounds of {} in turns\n", rounds, kSamples);
  fmt::print("{:<52} {:>8.0f}\n", "driver: READ?, status byte", median(ours));
  fmt::print("{:<52} {:>8.0f}\n", "bare libusb, the same four transfers", median(same));
  fmt::print("{:<52} {:>8.0f}\n", "bare libusb, without the status byte", median(least));
  fmt::print("{:<52} {:>8.3f}  (at least {})\n", "driver / bare, the same transfers", median(ratios), kLeastRatio);
  return median(ratios) >= kLeastRatio ? EXIT_SUCCESS : EXIT_FAILURE;
}
