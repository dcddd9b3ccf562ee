#include "daemon/engine/radiometer_actor.h"

#include <fmt/format.h>

#include <utility>
#include <variant>

namespace gonio::daemon {
namespace {

constexpr Duration kZeroLook = std::chrono::milliseconds(20);
constexpr Duration kZeroPause = std::chrono::milliseconds(1);

RadiometerActor::Answer refused(const DetectorRequest& request, const Error& error) {
  if (const auto* take = std::get_if<TakeFrame>(&request)) return FrameAnswer{take->ticket, failure(error)};
  return DetectorAnswer{std::visit([](const auto& r) { return r.ticket; }, request), failure(error)};
}

// One pixel, in parts of the range.
FrameSummary frame_of(const PowerRecord& power) {
  FrameSummary frame{.region = {.n = 1, .mean = power.reading.mean_w / power.reading.range_w}};
  frame.settings.exposure = power.ended - power.started;
  frame.power = power;
  return frame;
}

FrameSummary overload() {
  return {.region = {.n = 1, .mean = 1.0, .saturated = 1}};
}

}  // namespace

RadiometerActor::RadiometerActor(drivers::Radiometer& radiometer, PowerDetectorConfig config, Post post)
    : radiometer_(radiometer),
      config_(std::move(config)),
      task_(radiometer, config_.meter, "detector"),
      post_(std::move(post)) {}

void RadiometerActor::on(const DetectorRequest& request, Instant now) {
  if (waiting_.size() >= kMostWaiting) {
    post_(refused(request, {.code = ErrorCode::Busy,
                            .device = "detector",
                            .tried = "take a request",
                            .seen = "too many wait already",
                            .limit = std::to_string(kMostWaiting)}));
    return;
  }
  waiting_.push_back(request);
  if (!next_look()) static_cast<void>(step(now));
}

std::optional<Instant> RadiometerActor::step(Instant now) {
  if (reading_ && task_.next_look() <= now) look_at_reading(now);
  if (zeroing_ && zeroing_->next_look <= now) look_at_zero(now);
  while (!next_look() && !waiting_.empty()) {
    const DetectorRequest next = std::move(waiting_.front());
    waiting_.pop_front();
    std::visit([&](const auto& request) { begin(request, now); }, next);
  }
  return next_look();
}

std::optional<Instant> RadiometerActor::next_look() const {
  if (reading_) return task_.next_look();
  return zeroing_ ? std::optional(zeroing_->next_look) : std::nullopt;
}

void RadiometerActor::begin(const PrepareDetector& request, Instant /*now*/) {
  Result<drivers::DetectorIdentity> opened = radiometer_.ensure_open();
  if (opened) identity_ = *opened;
  post_(DetectorAnswer{request.ticket, std::move(opened)});
}

void RadiometerActor::begin(const ZeroDetector& request, Instant now) {
  if (auto started = radiometer_.start_zero(); !started) {
    post_(DetectorAnswer{request.ticket, failure(std::move(started).error())});
    return;
  }
  zeroing_ = Zeroing{.ticket = request.ticket, .next_look = now, .deadline = now + config_.zero_time};
}

void RadiometerActor::look_at_zero(Instant now) {
  const Result<bool> zeroed = radiometer_.is_zeroed(kZeroLook);
  const bool is_late = now >= zeroing_->deadline;
  if (zeroed && !*zeroed && !is_late) {
    zeroing_->next_look = now + kZeroPause;
    return;
  }
  const Ticket ticket = zeroing_->ticket;
  zeroing_.reset();
  if (!zeroed) {
    post_(DetectorAnswer{ticket, failure(zeroed.error())});
  } else if (*zeroed) {
    post_(DetectorAnswer{ticket, identity_});
  } else {
    post_(DetectorAnswer{ticket, failure({.code = ErrorCode::TimedOut,
                                          .device = "detector",
                                          .tried = "take the dark as zero",
                                          .seen = "it did not end",
                                          .limit = fmt::format("{} s", in_seconds(config_.zero_time))})});
  }
}

void RadiometerActor::begin(const TakeFrame& request, Instant now) {
  if (!request.power) {
    return answer(request, failure({.code = ErrorCode::InvalidInput,
                                    .device = "detector",
                                    .tried = "take a reading",
                                    .seen = "no range and wavelength",
                                    .limit = "both"}));
  }
  const auto started = task_.start({.wavelength = request.power->wavelength,
                                    .range_w = request.power->range_w,
                                    .averages = config_.meter.averages,
                                    .samples = config_.samples},
                                   now);
  if (!started) return answer(request, failure(started.error()));
  reading_ = Reading{request};
}

void RadiometerActor::look_at_reading(Instant now) {
  auto seen = task_.look(now);
  if (seen && !*seen) return;
  const TakeFrame request = std::exchange(reading_, std::nullopt)->request;
  if (seen) return answer(request, frame_of(**seen));
  if (seen.error().code == ErrorCode::Saturated) return answer(request, overload());
  answer(request, failure(std::move(seen).error()));
}

void RadiometerActor::answer(const TakeFrame& request, Result<FrameSummary> frame) {
  if (frame) frame->settings.exposure = request.settings.exposure;  // the rung's: what the wire took stands in `power`
  post_(FrameAnswer{request.ticket, std::move(frame)});
}

}  // namespace gonio::daemon
