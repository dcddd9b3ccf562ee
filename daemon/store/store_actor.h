#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "base/clock.h"
#include "daemon/sequencer/messages.h"
#include "daemon/store/store_writer.h"

namespace gonio::daemon {

/// The store's place among the actors: answers each request in the order of asking. `on` blocks for the durable write,
/// so it has its own thread. Threads: one.
class StoreActor {
 public:
  using Answer = std::variant<CommitAnswer, UnfinishedAnswer>;

  explicit StoreActor(StoreWriter& writer) : writer_(writer) {}

  /// The events in a CommitAnswer are durable: publish them before or after handing it on.
  [[nodiscard]] Answer on(const StoreRequest& request, Instant now);
  /// Never wants to be woken.
  [[nodiscard]] std::optional<Instant> step(Instant) { return std::nullopt; }

 private:
  StoreWriter& writer_;
};

}  // namespace gonio::daemon
