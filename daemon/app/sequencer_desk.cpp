#include "daemon/app/sequencer_desk.h"

#include <algorithm>

namespace gonio::daemon {
namespace {

Error not_taken(std::string device) {
  return {.code = ErrorCode::Busy,
          .device = std::move(device),
          .tried = "take on a request",
          .seen = "its mailbox is full",
          .limit = {}};
}

Ticket ticket_of(const auto& request) {
  return std::visit([](const auto& one) { return one.ticket; }, request);
}

}  // namespace

SequencerDesk::SequencerDesk(SequencerConfig config, Ports ports, Instant now)
    : ports_(std::move(ports)), sequencer_(std::move(config), now), next_look_(now) {}

void SequencerDesk::on(const SequencerMessage& message, Instant now) {
  if (std::holds_alternative<StageAnswer>(message)) next_look_ = now + ports_.look_every;
  sequencer_.on(message, now);
  hand_on(now);
}

std::optional<Instant> SequencerDesk::step(Instant now) {
  ports_.renew();
  const std::optional<Instant> wanted = sequencer_.step(now);
  hand_on(now);
  if (now >= next_look_) look_at_stage(now);
  const Instant latest = std::min(now + ports_.renew_every, next_look_);
  return wanted ? std::min(*wanted, latest) : latest;
}

SequencerStatus SequencerDesk::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void SequencerDesk::hand_on(Instant now) {
  std::vector<Request> requests = sequencer_.take_requests();
  // The detector's first: its thread is longer on its way to the light than the stage's to its first look at the gate.
  std::ranges::stable_partition(requests, [](const Request& r) { return std::holds_alternative<DetectorRequest>(r); });
  for (Request& request : requests) {
    std::visit([&](auto& one) { send(std::move(one), now); }, request);
  }
  for (const CommandReply& reply : sequencer_.take_replies()) ports_.reply(reply);
  SequencerStatus status = sequencer_.status(now);
  const std::lock_guard lock(mutex_);
  status_ = std::move(status);
}

void SequencerDesk::send(StageRequest request, Instant now) {
  const Ticket ticket = ticket_of(request);
  if (!ports_.to_stage(std::move(request))) on(StageAnswer{ticket, failure(not_taken("stage"))}, now);
}

void SequencerDesk::send(DetectorRequest request, Instant now) {
  const Ticket ticket = ticket_of(request);
  const bool is_frame = std::holds_alternative<TakeFrame>(request);
  if (ports_.to_detector(std::move(request))) return;
  if (is_frame) {
    on(FrameAnswer{ticket, failure(not_taken("detector"))}, now);
  } else {
    on(DetectorAnswer{ticket, failure(not_taken("detector"))}, now);
  }
}

void SequencerDesk::send(MonitorRequest request, Instant now) {
  const Ticket ticket = ticket_of(request);
  const bool is_reading = std::holds_alternative<TakeMonitor>(request);
  if (ports_.to_monitor(std::move(request))) return;
  if (is_reading) {
    on(MonitorAnswer{ticket, failure(not_taken("monitor"))}, now);
  } else {
    on(MonitorReady{ticket, failure(not_taken("monitor"))}, now);
  }
}

void SequencerDesk::send(StoreRequest request, Instant now) {
  const Ticket ticket = ticket_of(request);
  const bool is_commit = std::holds_alternative<Commit>(request);
  if (ports_.to_store(std::move(request))) return;
  if (is_commit) {
    on(CommitAnswer{ticket, failure(not_taken("store"))}, now);
  } else {
    on(UnfinishedAnswer{ticket, failure(not_taken("store"))}, now);
  }
}

// A stage that nobody asks for anything is still shown as it is.
void SequencerDesk::look_at_stage(Instant now) {
  next_look_ = now + ports_.look_every;
  (void)ports_.to_stage(LookAtStage{kOwnTicket});
}

}  // namespace gonio::daemon
