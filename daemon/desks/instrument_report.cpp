#include "daemon/desks/instrument_report.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

namespace gonio::daemon {
namespace {

std::string link_text(const StageAddress& address) {
  if (!address.serial) return fmt::format("tcp {}:{}", address.host, address.port);
  return fmt::format("rtu {} at {} baud", address.serial->device, address.serial->baud);
}

api::AxisLimits limits_of(const Instrument& instrument, stage::Axis axis) {
  const drivers::AxisConfig& config = instrument.stage.axis(axis);
  return {.name = std::string(stage::axis_name(axis)),
          .unit = std::string(stage::axis_unit(axis)),
          .low = config.low,
          .high = config.high,
          .speed_per_s = config.speed,
          .acceleration_per_s2 = config.acceleration,
          .settle_s = in_seconds(config.settle),
          .window = config.window};
}

std::int64_t free_bytes(const std::string& file) {
  std::error_code refused;
  const auto space = std::filesystem::space(std::filesystem::absolute(file).parent_path(), refused);
  return refused ? 0 : static_cast<std::int64_t>(space.available);
}

void add_detector(api::InstrumentReport& report, const Instrument& instrument) {
  report.detector_serial = instrument.detector.serial;
  report.shortest_exposure_s = in_seconds(instrument.detector.shortest_exposure);
  report.longest_exposure_s = in_seconds(instrument.detector.longest_exposure);
  report.full_scale_dn = instrument.model.detector.full_scale_dn;
  report.read_noise_dn = instrument.model.detector.read_noise_dn;
  report.electrons_per_dn = instrument.model.detector.electrons_per_dn;
}

}  // namespace

api::InstrumentReport instrument_report(const Instrument& instrument, const std::string& store_file) {
  api::InstrumentReport report{.name = instrument.name,
                               .sha256 = instrument.sha256,
                               .stage_link = link_text(instrument.stage_address),
                               .heartbeat_timeout_s = in_seconds(instrument.stage.heartbeat_timeout),
                               .sample_mm = in_millimetres(instrument.carriage.sample),
                               .reference_mm = in_millimetres(instrument.carriage.reference),
                               .trap_mm = in_millimetres(instrument.carriage.trap),
                               .monitor_low = instrument.lamp.low,
                               .monitor_high = instrument.lamp.high,
                               .store_free_bytes = free_bytes(store_file)};
  for (const stage::Axis axis : stage::kAllAxes) report.axes.push_back(limits_of(instrument, axis));
  for (const Filter& filter : instrument.filters) {
    report.filters.push_back(
        {.slot = filter.slot,
         .centroid_nm = in_nanometres(filter.centroid),
         .fwhm_nm = in_nanometres(filter.fwhm),
         .side = filter.side == FilterSide::Source ? "source" : "detector",
         .attenuation = filter.attenuation ? std::optional(filter.attenuation->value) : std::nullopt});
  }
  if (instrument.carriage.open) report.open_mm = in_millimetres(*instrument.carriage.open);
  add_detector(report, instrument);
  return report;
}

}  // namespace gonio::daemon
