#pragma once

#include <functional>
#include <mutex>

#include "base/clock.h"
#include "daemon/sequencer/sequencer.h"

namespace gonio::daemon {

/// Runs the sequencer as an actor: hands its requests and replies on after each message and step, keeps a copy of its
/// status for other threads, renews the engine's sign of life, and has the stage looked at when nobody else does.
class SequencerDesk {
 public:
  /// Where the sequencer's words go. False: not taken, which is answered at once with Busy.
  struct Ports {
    std::function<bool(StageRequest)> to_stage;
    std::function<bool(DetectorRequest)> to_detector;
    std::function<bool(MonitorRequest)> to_monitor;
    std::function<bool(StoreRequest)> to_store;
    std::function<void(const CommandReply&)> reply;
    std::function<void()> renew;  ///< the engine lives
    Duration renew_every{};
    Duration look_every = std::chrono::seconds(1);
  };
  /// Tickets of this desk's own looks at the stage: the sequencer watches door and lamp by them.
  static constexpr Ticket kOwnTicket = kWatchTicket;

  SequencerDesk(SequencerConfig config, Ports ports, Instant now);

  void on(const SequencerMessage& message, Instant now);
  [[nodiscard]] std::optional<Instant> step(Instant now);

  /// Threads: any.
  [[nodiscard]] SequencerStatus status() const;

 private:
  void hand_on(Instant now);
  void send(StageRequest request, Instant now);
  void send(DetectorRequest request, Instant now);
  void send(MonitorRequest request, Instant now);
  void send(StoreRequest request, Instant now);
  void look_at_stage(Instant now);

  Ports ports_;
  Sequencer sequencer_;
  Instant next_look_{};
  mutable std::mutex mutex_;
  SequencerStatus status_;
};

/// The store is asked by the sequencer and, with the ticket of nobody, by others.
[[nodiscard]] inline std::uint8_t source_of(const StoreRequest& request) {
  constexpr std::uint8_t kOfOthers = 16;
  const auto* commit = std::get_if<Commit>(&request);
  const bool is_of_others = commit != nullptr && commit->ticket == SequencerDesk::kOwnTicket;
  return static_cast<std::uint8_t>(request.index() + 1 + (is_of_others ? kOfOthers : 0));
}

}  // namespace gonio::daemon
