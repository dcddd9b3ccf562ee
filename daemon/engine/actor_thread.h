#pragma once

#include <pthread.h>

#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "base/clock.h"
#include "daemon/engine/turns.h"

namespace gonio::daemon {

/// Runs an actor on a thread of its own: `on(message, now)` for each message, then `step(now)`, which says when to come
/// again. The actor is touched by this thread only, from construction until `stop` has returned.
template <class Actor, class Message>
class ActorThread {
 public:
  /// Called on the actor's thread when something was thrown through the actor: a bug, so make safe and end the program.
  using OnBug = std::function<void(const std::string& what)>;

  /// `actor` and `clock` must outlive the thread. `name` is cut to what the system shows, 15 characters.
  ActorThread(std::string name, Actor& actor, const Clock& clock, std::size_t capacity, OnBug on_bug, Turns turns = {})
      : actor_(actor), clock_(clock), turns_(turns), queue_(capacity, turns.by_hand), on_bug_(std::move(on_bug)) {
    if (turns_.by_hand) return;
    thread_ = std::thread([this] { run(); });
    pthread_setname_np(thread_.native_handle(), name.substr(0, 15).c_str());
  }
  ~ActorThread() { stop(); }
  ActorThread(const ActorThread&) = delete;
  ActorThread& operator=(const ActorThread&) = delete;

  /// False when the mailbox is full or closed. Threads: any.
  [[nodiscard]] bool post(Message message) { return queue_.post(std::move(message)); }

  /// Only with Turns::by_hand. Errors: ReplayDiffers.
  [[nodiscard]] Result<void> take_turn(const drivers::TapeTurn& turn) { return take_turn_of(actor_, queue_, turn); }

  /// Ends after the message or step in hand; what waits in the mailbox is dropped. Not from the actor's own thread.
  void stop() {
    queue_.close();
    if (thread_.joinable()) thread_.join();
  }

 private:
  void run() noexcept {
    try {
      loop();
    } catch (const std::exception& bug) {
      on_bug_(bug.what());
    }
  }

  void loop() {
    std::optional<Instant> wake = step();
    while (!queue_.is_closed()) {
      std::optional<Message> message = queue_.take_until(wake, clock_);
      if (message) give(std::move(*message));
      if (!queue_.is_closed()) wake = step();
    }
  }

  void give(Message message) {
    const Instant now = clock_.now();
    if (turns_.tape != nullptr) turns_.note(source_of(message), now);
    actor_.on(std::move(message), now);
  }

  std::optional<Instant> step() {
    const Instant now = clock_.now();
    turns_.note(kNoSource, now);
    return actor_.step(now);
  }

  Actor& actor_;
  const Clock& clock_;
  const Turns turns_;
  TurnQueue<Message> queue_;
  OnBug on_bug_;
  std::thread thread_;
};

}  // namespace gonio::daemon
