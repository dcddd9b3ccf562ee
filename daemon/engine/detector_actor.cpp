#include "daemon/engine/detector_actor.h"

#include <utility>

namespace gonio::daemon {
namespace {

constexpr Duration kBetweenLooks = std::chrono::milliseconds(1);

Error busy() {
  return {.code = ErrorCode::Busy,
          .device = "detector",
          .tried = "take a request",
          .seen = "too many wait already",
          .limit = std::to_string(DetectorActor::kMostWaiting)};
}

DetectorActor::Answer refusal(const DetectorRequest& request, const Error& error) {
  if (const auto* take = std::get_if<TakeFrame>(&request)) return FrameAnswer{take->ticket, failure(error)};
  return DetectorAnswer{std::get<PrepareDetector>(request).ticket, failure(error)};
}

}  // namespace

DetectorActor::DetectorActor(drivers::Detector& detector, FrameReduction reduction, Post post)
    : detector_(detector), reduction_(std::move(reduction)), post_(std::move(post)) {}

void DetectorActor::on(const DetectorRequest& request, Instant now) {
  if (waiting_.size() >= kMostWaiting) {
    post_(refusal(request, busy()));
    return;
  }
  waiting_.push_back(request);
  if (!exposure_) static_cast<void>(step(now));
}

std::optional<Instant> DetectorActor::step(Instant now) {
  if (exposure_ && exposure_->next_look <= now) collect(now);
  while (!exposure_ && !waiting_.empty()) {
    const DetectorRequest next = std::move(waiting_.front());
    waiting_.pop_front();
    begin(next, now);
  }
  if (!exposure_) return std::nullopt;
  return exposure_->next_look;
}

void DetectorActor::begin(const DetectorRequest& request, Instant now) {
  if (const auto* frame = std::get_if<TakeFrame>(&request)) {
    take(*frame, now);
  } else {
    post_(DetectorAnswer{std::get<PrepareDetector>(request).ticket, detector_.ensure_open()});
  }
}

void DetectorActor::take(const TakeFrame& request, Instant now) {
  Result<void> begun = detector_.apply(request.settings);
  if (begun) begun = detector_.trigger();
  if (!begun) {
    post_(FrameAnswer{request.ticket, failure(std::move(begun).error())});
    return;
  }
  exposure_ = Exposure{request.ticket, now + request.settings.exposure, request.sums};
}

void DetectorActor::collect(Instant now) {
  Result<std::optional<drivers::Frame>> collected = detector_.collect(kLookTime);
  if (collected && !*collected) {
    exposure_->next_look = now + kBetweenLooks;
    return;
  }
  const Exposure over = *std::exchange(exposure_, std::nullopt);
  post_(FrameAnswer{over.ticket,
                    collected ? summary_of(**collected, over.sums.get()) : failure(std::move(collected).error())});
}

Result<void> DetectorActor::prepare_for(const drivers::Frame& frame) {
  if (prepared_ && prepared_->width == frame.width && prepared_->height == frame.height &&
      prepared_->significant_bits == frame.significant_bits) {
    return {};
  }
  const auto full_scale = static_cast<std::uint16_t>((1U << static_cast<unsigned>(frame.significant_bits)) - 1U);
  const auto maps = reduction_.maps ? std::optional(*reduction_.maps) : std::nullopt;
  auto reducer = calibration::FrameReducer::prepare(frame.width, frame.height, full_scale, reduction_.aperture, maps,
                                                    reduction_.noise);
  if (!reducer) return failure(std::move(reducer).error());
  prepared_ = Prepared{frame.width, frame.height, frame.significant_bits, std::move(*reducer)};
  return {};
}

Result<FrameSummary> DetectorActor::summary_of(const drivers::Frame& frame, calibration::PixelSums* sums) {
  GONIO_TRY(prepare_for(frame));
  const calibration::FrameReducer& reducer = prepared_->reducer;
  const auto reduced = reducer.reduce(frame.pixels, in_seconds(frame.settings.exposure), frame.settings.gain_db);
  if (!reduced) return failure(reduced.error());
  if (sums != nullptr) {
    GONIO_TRY(calibration::add_frame(*sums,
                                     {.pixels = frame.pixels,
                                      .width = frame.width,
                                      .height = frame.height,
                                      .exposure = frame.settings.exposure,
                                      .gain_db = frame.settings.gain_db},
                                     reduction_.aperture));
  }
  return FrameSummary{.region = reduced->raw,
                      .reduced = reduced->reduced,
                      .maps_version = reducer.version(),
                      .settings = frame.settings,
                      .frame_id = frame.frame_id,
                      .camera_time_ns = frame.camera_time_ns,
                      .temperature_c = frame.temperature_c};
}

}  // namespace gonio::daemon
