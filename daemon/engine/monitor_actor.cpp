#include "daemon/engine/monitor_actor.h"

#include <string>
#include <utility>

namespace gonio::daemon {
namespace {

MonitorActor::Answer not_taken_on(const MonitorRequest& request) {
  const Error busy{.code = ErrorCode::Busy,
                   .device = "monitor",
                   .tried = "take a request",
                   .seen = "too many wait already",
                   .limit = std::to_string(MonitorActor::kMostWaiting)};
  if (const auto* take = std::get_if<TakeMonitor>(&request)) return MonitorAnswer{take->ticket, failure(busy)};
  return MonitorReady{std::get<PrepareMonitor>(request).ticket, failure(busy)};
}

}  // namespace

MonitorActor::MonitorActor(drivers::Radiometer& radiometer, PowerMonitorConfig config, Post post)
    : radiometer_(radiometer),
      config_(std::move(config)),
      task_(radiometer, config_.meter, "monitor"),
      post_(std::move(post)) {}

void MonitorActor::on(const MonitorRequest& request, Instant now) {
  if (waiting_.size() >= kMostWaiting) return post_(not_taken_on(request));
  waiting_.push_back(request);
  if (!reading_) static_cast<void>(step(now));
}

std::optional<Instant> MonitorActor::step(Instant now) {
  if (reading_ && task_.next_look() <= now) look(now);
  while (!reading_ && !waiting_.empty()) {
    const MonitorRequest next = waiting_.front();
    waiting_.pop_front();
    std::visit([&](const auto& request) { begin(request, now); }, next);
  }
  return reading_ ? std::optional(task_.next_look()) : std::nullopt;
}

void MonitorActor::begin(const PrepareMonitor& request, Instant /*now*/) {
  post_(MonitorReady{request.ticket, radiometer_.ensure_open()});
}

void MonitorActor::begin(const TakeMonitor& request, Instant now) {
  const auto started = task_.start({.wavelength = config_.wavelength,
                                    .range_w = config_.range_w,
                                    .averages = config_.meter.averages,
                                    .samples = config_.samples_in(request.window)},
                                   now);
  if (!started) return post_(MonitorAnswer{request.ticket, failure(started.error())});
  reading_ = request.ticket;
}

void MonitorActor::look(Instant now) {
  auto seen = task_.look(now);
  if (seen && !*seen) return;
  const Ticket ticket = *std::exchange(reading_, std::nullopt);
  post_(MonitorAnswer{ticket, seen ? Result<PowerRecord>(**seen) : failure(std::move(seen).error())});
}

}  // namespace gonio::daemon
