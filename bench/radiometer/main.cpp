// Samples a second of the radiometer's driver through libusb, beside bare libusb loops with the same transfers, on a
// USB that is emulated below libc. In turns, so that a machine that slows down slows all of them. Usage:
// bench_radiometer [ROUNDS]
#include <fmt/format.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>

#include "bench/wires/contest.h"
#include "drivers/links/libusb_usbtmc_link.h"
#include "drivers/radiometer/scpi_radiometer.h"
#include "protocol/usbtmc/message.h"
#include "reflectance/surface/make_surface.h"
#include "sim/wires/usb_bus.h"

namespace {

using namespace gonio;
using sim::UsbtmcFunction;

constexpr int kSamples = 200;  // of a stretch
constexpr unsigned kTimeoutMs = 10000;

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
  // A reading is so many samples, with a question for the range before and behind them.
  return kSamples * bench::per_second(1, [&] {
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
  return bench::per_second(kSamples, [&] { return bare_sample(handle.get(), tags, with_status); });
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  const SystemClock clock;
  sim::LiveInstrument instrument(scene(), {}, clock);
  sim::LiveRadiometer meter(instrument, monitor(), false);
  sim::UsbBus bus(meter);
  if (!bus.plug()) return EXIT_FAILURE;
  bench::print_heading();
  const bool holds = bench::hold({.what = "radiometer, USBTMC: READ?, status byte (four transfers)",
                                  .ours = [] { return driver_rate(); },
                                  .bare = [] { return bare_rate(true); }},
                                 rounds);
  // What the status byte costs: a driver without it would not know whose reply it has.
  const double least = bare_rate(false);
  fmt::print("{:<58} {:>10} {:>10.0f}\n", "  the same without the status byte", "", least);
  return holds ? EXIT_SUCCESS : EXIT_FAILURE;
}
