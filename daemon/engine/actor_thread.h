#pragma once

#include <pthread.h>

#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "base/clock.h"
#include "daemon/engine/mailbox.h"

namespace gonio::daemon {

/// Runs an actor on a thread of its own: `on(message, now)` for each message, then `step(now)`, which says when to come
/// again. The actor is touched by this thread only, from construction until `stop` has returned.
template <class Actor, class Message>
class ActorThread {
 public:
  /// Called on the actor's thread when something was thrown through the actor: a bug, so make safe and end the program.
  using OnBug = std::function<void(const std::string& what)>;

  /// `actor` and `clock` must outlive the thread. `name` is cut to what the system shows, 15 characters.
  ActorThread(std::string name, Actor& actor, const Clock& clock, std::size_t capacity, OnBug on_bug)
      : actor_(actor), clock_(clock), mailbox_(capacity), on_bug_(std::move(on_bug)), thread_([this] { run(); }) {
    pthread_setname_np(thread_.native_handle(), name.substr(0, 15).c_str());
  }
  ~ActorThread() { stop(); }
  ActorThread(const ActorThread&) = delete;
  ActorThread& operator=(const ActorThread&) = delete;

  /// False when the mailbox is full or closed. Threads: any.
  [[nodiscard]] bool post(Message message) { return mailbox_.post(std::move(message)); }

  /// Ends after the message or step in hand; what waits in the mailbox is dropped. Not from the actor's own thread.
  void stop() {
    mailbox_.close();
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
    std::optional<Instant> wake = actor_.step(clock_.now());
    while (!mailbox_.is_closed()) {
      std::optional<Message> message = mailbox_.take_until(wake, clock_);
      if (message) actor_.on(std::move(*message), clock_.now());
      if (!mailbox_.is_closed()) wake = actor_.step(clock_.now());
    }
  }

  Actor& actor_;
  const Clock& clock_;
  Mailbox<Message> mailbox_;
  OnBug on_bug_;
  std::thread thread_;
};

}  // namespace gonio::daemon
