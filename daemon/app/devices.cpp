#include "daemon/app/devices.h"

#include <optional>
#include <string>

#include "daemon/app/stage_devices.h"
#include "drivers/genicam_camera/genicam_camera.h"
#include "drivers/links/aravis_camera_link.h"
#include "drivers/links/libusb_usbtmc_link.h"
#include "drivers/radiometer/scpi_radiometer.h"

namespace gonio::daemon {
namespace {

using drivers::TapeParty;

drivers::AravisCameraConfig camera_link_of(const DetectorConfig& detector) {
  const bool is_usb = detector.link == CameraLinkKind::Usb3;
  return {.address = detector.address,
          .serial = detector.serial,
          .transport = is_usb ? drivers::CameraTransport::Usb3 : drivers::CameraTransport::Gige};
}

drivers::GenicamCameraConfig camera_of(const DetectorConfig& detector) {
  return {.serial = detector.serial,
          .format = {.width = detector.width_px,
                     .height = detector.height_px,
                     .offset_x = detector.offset_x_px,
                     .offset_y = detector.offset_y_px,
                     .pixel_format = detector.pixel_format,
                     .packet_size_bytes = detector.packet_size_bytes},
          .settings = {.exposure = detector.shortest_exposure, .gain_db = detector.gain_db}};
}

// A meter answers within milliseconds, unless its bus or its own display is busy.
constexpr Duration kMeterPatience = std::chrono::seconds(2);

/// A radiometer on its link, in one of its two places.
class PowerMeter {
 public:
  PowerMeter(const PowerMeterConfig& meter, drivers::RadiometerSettings settings, Duration zero_time,
             const std::string& role, TapeDeck& deck, TapeParty party)
      : link_({.role = role, .vendor_id = meter.vendor_id, .product_id = meter.product_id, .serial = meter.serial}),
        driver_(deck.usbtmc(link_, party),
                {.role = role,
                 .serial = meter.serial,
                 .settings = settings,
                 .sample_time = meter.sample_time,
                 .range_settle = meter.settle,
                 .zero_time = zero_time,
                 .reply_margin = kMeterPatience,
                 .transfer_timeout = kMeterPatience},
                deck.clock(party)) {}

  [[nodiscard]] drivers::Radiometer& driver() { return driver_; }

 private:
  drivers::LibusbUsbtmcLink link_;
  drivers::ScpiRadiometer driver_;
};

}  // namespace

struct Devices::Impl {
  Impl(const Instrument& of, TapeDeck& deck)
      : instrument(of), stage(instrument, deck), engine_halt_line(deck.halt_line(stage.halt_line())) {
    if (instrument.detector.power) {
      make_radiometer(*instrument.detector.power, deck);
    } else {
      camera_link.emplace(camera_link_of(instrument.detector));
      camera.emplace(deck.camera(*camera_link, TapeParty::Detector), camera_of(instrument.detector),
                     deck.clock(TapeParty::Detector));
    }
    if (instrument.monitor) make_monitor(*instrument.monitor, deck);
  }

  void make_radiometer(const PowerDetectorConfig& power, TapeDeck& deck) {
    const Wavelength any = instrument.filters.front().centroid;  // each scan sets its own
    radiometer.emplace(power.meter,
                       drivers::RadiometerSettings{.wavelength = any,
                                                   .range_w = power.ranges_w.front(),
                                                   .averages = power.meter.averages,
                                                   .samples = power.samples},
                       power.zero_time, "detector", deck, TapeParty::Detector);
  }

  void make_monitor(const PowerMonitorConfig& config, TapeDeck& deck) {
    monitor.emplace(config.meter,
                    drivers::RadiometerSettings{.wavelength = config.wavelength,
                                                .range_w = config.range_w,
                                                .averages = config.meter.averages,
                                                .samples = PowerMonitorConfig::kFewestSamples},
                    config.meter.settle, "monitor", deck, TapeParty::Monitor);
  }

  const Instrument instrument;
  StageDevices stage;
  drivers::HaltLine& engine_halt_line;                   ///< the same, as the engine is to see it
  std::optional<drivers::AravisCameraLink> camera_link;  ///< and `camera`, or `radiometer`
  std::optional<drivers::GenicamCamera> camera;
  std::optional<PowerMeter> radiometer;
  std::optional<PowerMeter> monitor;
};

Devices::Devices(const Instrument& instrument, TapeDeck& deck) : impl_(std::make_unique<Impl>(instrument, deck)) {}

Devices::~Devices() = default;

EngineDevices Devices::all() {
  return {.stage = impl_->stage.stage(),
          .halt_line = impl_->engine_halt_line,
          .camera = impl_->camera ? &*impl_->camera : nullptr,
          .radiometer = impl_->radiometer ? &impl_->radiometer->driver() : nullptr,
          .monitor = impl_->monitor ? &impl_->monitor->driver() : nullptr};
}

drivers::HaltLine& Devices::halt_line() {
  return impl_->stage.halt_line();
}

}  // namespace gonio::daemon
