#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>

namespace gonio::daemon {

/// How an event client's connection is moved from outside. Called with the client's lock held; must not call back.
struct ConnectionHooks {
  std::function<void()> suspend;  ///< nothing to send: do not ask until resumed
  std::function<void()> resume;
  std::function<void()> hang_up;  ///< the client is too slow: end its connection
};

/// One reader of the event stream: what waits for it, bounded in bytes.
/// It is *live* when the hub hands it each event as it comes, else it *catches up*: a worker fetches from the store
/// what it has not had, and hands that over. Threads: any.
class EventClient {
 public:
  /// `after`: the last event that it has.
  EventClient(std::int64_t after, bool live, std::size_t limit_bytes, ConnectionHooks hooks);

  /// Takes up to `buffer.size()` bytes; with nothing there it suspends the connection and returns 0. After `close` or
  /// being dropped: -1. `needs_more` is set when it has sent all that was fetched and is not live.
  [[nodiscard]] std::ptrdiff_t read(std::span<char> buffer, bool& needs_more);

  /// A live event. False: it was not taken because the client is behind a gap and must catch up.
  bool offer(std::int64_t number, const std::shared_ptr<const std::string>& text);
  /// An event out of the store; those it has already are passed over.
  void add_fetched(std::int64_t number, const std::string& text);
  /// A comment, when nothing else waits: shows a dead peer, and keeps middle boxes patient.
  void keep_alive();

  /// Catching up: true if a fetch may begin (none is under way, not live, room for more).
  [[nodiscard]] bool begin_fetch();
  /// `live`: all that is published was fetched.
  void end_fetch(bool live);

  [[nodiscard]] std::int64_t last() const;
  [[nodiscard]] bool has_room() const;
  void drop();
  /// The connection is gone: no hook is called any more.
  void close();
  [[nodiscard]] bool is_open() const;
  [[nodiscard]] bool was_dropped() const;

 private:
  void push(std::shared_ptr<const std::string> text);
  void wake();
  void drop_locked();

  mutable std::mutex mutex_;
  const std::size_t limit_bytes_;
  ConnectionHooks hooks_;
  std::deque<std::shared_ptr<const std::string>> queue_;
  std::size_t queued_bytes_ = 0;
  std::size_t sent_of_first_ = 0;
  std::int64_t last_;
  bool live_;
  bool fetching_ = false;
  bool suspended_ = false;
  bool dropped_ = false;
  bool open_ = true;
};

}  // namespace gonio::daemon
