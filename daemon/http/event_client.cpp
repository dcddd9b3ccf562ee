#include "daemon/http/event_client.h"

#include <algorithm>

namespace gonio::daemon {

EventClient::EventClient(std::int64_t after, bool live, std::size_t limit_bytes, ConnectionHooks hooks)
    : limit_bytes_(limit_bytes), hooks_(std::move(hooks)), last_(after), live_(live) {
  // The first bytes go out at once, so that a client knows that it is connected.
  push(std::make_shared<const std::string>("retry: 2000\n: goniod\n\n"));
}

std::ptrdiff_t EventClient::read(std::span<char> buffer, bool& needs_more) {
  const std::lock_guard lock(mutex_);
  needs_more = false;
  if (dropped_ || !open_) return -1;
  if (queue_.empty()) {
    needs_more = !live_ && !fetching_;
    suspended_ = true;
    hooks_.suspend();
    return 0;
  }
  std::size_t copied = 0;
  while (copied < buffer.size() && !queue_.empty()) {
    const std::string& first = *queue_.front();
    const std::size_t n = first.copy(buffer.data() + copied, buffer.size() - copied, sent_of_first_);
    copied += n;
    sent_of_first_ += n;
    if (sent_of_first_ < first.size()) break;
    queued_bytes_ -= first.size();
    sent_of_first_ = 0;
    queue_.pop_front();
  }
  return static_cast<std::ptrdiff_t>(copied);
}

bool EventClient::offer(std::int64_t number, const std::shared_ptr<const std::string>& text) {
  const std::lock_guard lock(mutex_);
  if (!live_ || number <= last_) return true;
  if (number != last_ + 1) {
    live_ = false;
    return false;
  }
  last_ = number;
  push(text);
  return true;
}

void EventClient::add_fetched(std::int64_t number, const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (number <= last_) return;
  last_ = number;
  push(std::make_shared<const std::string>(text));
}

void EventClient::keep_alive() {
  const std::lock_guard lock(mutex_);
  if (queue_.empty()) push(std::make_shared<const std::string>(": still here\n\n"));
}

bool EventClient::begin_fetch() {
  const std::lock_guard lock(mutex_);
  if (live_ || fetching_ || dropped_ || !open_ || queued_bytes_ > limit_bytes_ / 2) return false;
  fetching_ = true;
  return true;
}

void EventClient::end_fetch(bool live) {
  const std::lock_guard lock(mutex_);
  fetching_ = false;
  live_ = live;
  if (!live) wake();  // its next read asks for more once it has sent what it has
}

std::int64_t EventClient::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

bool EventClient::has_room() const {
  const std::lock_guard lock(mutex_);
  return queued_bytes_ <= limit_bytes_ / 2;
}

void EventClient::drop() {
  const std::lock_guard lock(mutex_);
  drop_locked();
}

void EventClient::close() {
  const std::lock_guard lock(mutex_);
  open_ = false;
  queue_.clear();
  queued_bytes_ = 0;
}

bool EventClient::is_open() const {
  const std::lock_guard lock(mutex_);
  return open_ && !dropped_;
}

bool EventClient::was_dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

void EventClient::push(std::shared_ptr<const std::string> text) {
  if (!open_ || dropped_) return;
  if (queued_bytes_ + text->size() > limit_bytes_) {
    drop_locked();
    return;
  }
  queued_bytes_ += text->size();
  queue_.push_back(std::move(text));
  wake();
}

void EventClient::wake() {
  if (!suspended_ || !open_) return;
  suspended_ = false;
  hooks_.resume();
}

void EventClient::drop_locked() {
  if (!open_ || dropped_) return;
  dropped_ = true;
  queue_.clear();
  queued_bytes_ = 0;
  hooks_.hang_up();
  wake();
}

}  // namespace gonio::daemon
