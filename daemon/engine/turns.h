#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/engine/mailbox.h"
#include "drivers/links/tape/tape_sink.h"

namespace gonio::daemon {

/// How an actor's turns go: by its thread, and recorded on a tape if there is one; or by hand, as a tape has them.
struct Turns {
  drivers::TapeParty party = drivers::TapeParty::Stage;
  drivers::TapeSink* tape = nullptr;  ///< must outlive the actor
  bool by_hand = false;               ///< no thread: `take_turn` alone makes the actor do anything

  void note(std::uint8_t source, Instant now) const {
    if (tape != nullptr) tape->put(drivers::TapeTurn{.party = party, .source = source, .now = now});
  }
};

/// The source of a turn in which nothing was given: it was the actor's time.
inline constexpr std::uint8_t kNoSource = 0;

/// From whom a message is, for the order among several senders: one number for each kind of message, since no kind has
/// two senders; kinds that do overload this. 0 is nobody.
template <class Message>
[[nodiscard]] std::uint8_t source_of(const Message& /*of_one_kind*/) {
  return 1;
}
template <class... Kinds>
[[nodiscard]] std::uint8_t source_of(const std::variant<Kinds...>& message) {
  return static_cast<std::uint8_t>(message.index() + 1);
}

/// The messages that wait for an actor. With `Turns::by_hand` they wait sorted by source, in the order of posting.
template <class Message>
class TurnQueue {
 public:
  TurnQueue(std::size_t capacity, bool by_hand) : mailbox_(capacity), capacity_(capacity), by_hand_(by_hand) {}

  /// False when it is full or closed. Threads: any.
  [[nodiscard]] bool post(Message message) {
    if (!by_hand_) return mailbox_.post(std::move(message));
    std::deque<Message>& queue = sorted_[source_of(message)];
    if (queue.size() >= capacity_) return false;
    queue.push_back(std::move(message));
    return true;
  }
  [[nodiscard]] std::optional<Message> take_until(std::optional<Instant> wake, const Clock& clock) {
    return mailbox_.take_until(wake, clock);
  }
  /// The oldest of this source; only by hand.
  [[nodiscard]] std::optional<Message> take_from(std::uint8_t source) {
    std::deque<Message>& queue = sorted_[source];
    if (queue.empty()) return std::nullopt;
    std::optional<Message> oldest(std::move(queue.front()));
    queue.pop_front();
    return oldest;
  }
  void close() { mailbox_.close(); }
  [[nodiscard]] bool is_closed() const { return mailbox_.is_closed(); }

 private:
  Mailbox<Message> mailbox_;
  const std::size_t capacity_;
  const bool by_hand_;
  std::map<std::uint8_t, std::deque<Message>> sorted_;
};

/// One recorded turn of an actor, again. Errors: ReplayDiffers (nobody has sent the message that it was given then).
template <class Actor, class Message>
[[nodiscard]] Result<void> take_turn_of(Actor& actor, TurnQueue<Message>& queue, const drivers::TapeTurn& turn) {
  if (turn.source == kNoSource) {
    static_cast<void>(actor.step(turn.now));
    return {};
  }
  std::optional<Message> message = queue.take_from(turn.source);
  if (!message) {
    return failure({.code = ErrorCode::ReplayDiffers,
                    .device = std::string(drivers::tape_party_name(turn.party)),
                    .tried = "take its turn",
                    .seen = "nothing of kind " + std::to_string(turn.source) + " was sent to it now",
                    .limit = "then there was"});
  }
  actor.on(std::move(*message), turn.now);
  return {};
}

}  // namespace gonio::daemon
