#include "daemon/engine/power_task.h"

#include <fmt/format.h>

#include <utility>

namespace gonio::daemon {
namespace {

constexpr Duration kSampleLook = std::chrono::milliseconds(20);
constexpr Duration kSamplePause = std::chrono::milliseconds(1);
// Each sample is an exchange of its own; a meter on a slow bus takes a few milliseconds for it.
constexpr Duration kSampleExchange = std::chrono::milliseconds(50);
constexpr Duration kReadingPatience = std::chrono::seconds(5);

Duration sampling_time(const PowerMeterConfig& meter, const drivers::RadiometerSettings& settings) {
  return settings.averages * settings.samples * meter.sample_time;
}

}  // namespace

PowerTask::PowerTask(drivers::Radiometer& radiometer, PowerMeterConfig meter, std::string role)
    : radiometer_(radiometer), meter_(std::move(meter)), role_(std::move(role)) {}

Result<void> PowerTask::start(const drivers::RadiometerSettings& settings, Instant now) {
  const bool is_changed = applied_ != settings;
  if (is_changed) {
    forget();
    GONIO_TRY(radiometer_.apply(settings));
  }
  if (auto triggered = radiometer_.trigger(); !triggered) {
    forget();
    return triggered;
  }
  applied_ = settings;
  const Duration sampling = sampling_time(meter_, settings);
  next_look_ = now;  // looking is what asks for the next sample
  deadline_ = now + 2 * (sampling + meter_.settle) + settings.samples * kSampleExchange + kReadingPatience;
  return {};
}

Result<std::optional<PowerRecord>> PowerTask::look(Instant now) {
  auto collected = radiometer_.collect(kSampleLook);
  if (!collected) {
    forget();
    return failure(std::move(collected).error());
  }
  if (!*collected) {
    next_look_ = now + kSamplePause;
    if (now < deadline_) return std::nullopt;
    forget();
    return failure(Error{.code = ErrorCode::TimedOut,
                         .device = role_,
                         .tried = fmt::format("take a reading of {} samples", applied_ ? applied_->samples : 0),
                         .seen = "it did not end",
                         .limit = "twice its time and settling, and 5 s"});
  }
  const drivers::RadiometerReading& reading = **collected;
  return PowerRecord{.reading = {.mean_w = reading.mean_w,
                                 .standard_error_w = reading.standard_error_w,
                                 .samples = reading.samples,
                                 .averages = applied_->averages,
                                 .range_w = reading.range_w,
                                 .wavelength = applied_->wavelength},
                     .started = reading.started,
                     .ended = reading.ended};
}

}  // namespace gonio::daemon
