#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "daemon/config/instrument.h"
#include "daemon/sequencer/command.h"
#include "daemon/sequencer/messages.h"

namespace gonio::daemon {

struct SequencerConfig {
  Instrument instrument;     ///< a scan accepted under another sha256 holds at its restart
  drivers::Epoch epoch = 0;  ///< the halt path's, at start; a higher one of the stage is taken over
};

/// The life of scans (DESIGN 5): a single-threaded state machine. Messages in, requests out; it never blocks, reads a
/// clock or touches a device. Its first request asks the store for what is not over. Threads: one.
class Sequencer {
 public:
  Sequencer(SequencerConfig config, Instant now);
  ~Sequencer();
  Sequencer(Sequencer&&) noexcept;
  Sequencer& operator=(Sequencer&&) noexcept;

  void on(const SequencerMessage& message, Instant now);
  /// Does what the passing of time asks for; says when to come again at the latest.
  [[nodiscard]] std::optional<Instant> step(Instant now);

  /// What is to be sent since the last call, in order. Call after each `on` and `step`.
  [[nodiscard]] std::vector<Request> take_requests();
  [[nodiscard]] std::vector<CommandReply> take_replies();
  [[nodiscard]] SequencerStatus status(Instant now) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::daemon
