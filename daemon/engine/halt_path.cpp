#include "daemon/engine/halt_path.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

namespace gonio::daemon {
namespace {

// The wait's own clock stands while the machine sleeps, ours does not: so it is asked again now and then.
constexpr Duration kLongestWait = std::chrono::seconds(1);
constexpr int kBeatsPerTimeout = 4;

}  // namespace

HaltPath::HaltPath(drivers::HaltLine& line, const Clock& clock, HaltPathConfig config, Report report)
    : line_(line),
      clock_(clock),
      config_(config),
      report_(std::move(report)),
      epoch_(config.first_epoch),
      next_beat_(clock.now()),
      thread_([this] { run(); }) {
  pthread_setname_np(thread_.native_handle(), "halt");
}

HaltPath::~HaltPath() {
  {
    const std::lock_guard lock(mutex_);
    is_closing_ = true;
    if (is_feeding_) line_.interrupt();
  }
  wake_.notify_all();
  thread_.join();
}

drivers::Epoch HaltPath::stop(const std::string& who) {
  drivers::Epoch raised = 0;
  {
    const std::lock_guard lock(mutex_);
    raised = ++epoch_;
    if (pending_) {
      pending_->epoch = raised;
    } else {
      pending_ = Pending{raised, who, clock_.now()};
      next_try_ = pending_->asked;
    }
    if (is_feeding_) line_.interrupt();
  }
  wake_.notify_all();
  return raised;
}

drivers::Epoch HaltPath::epoch() const {
  const std::lock_guard lock(mutex_);
  return epoch_;
}

void HaltPath::adopt(drivers::Epoch at_least) {
  const std::lock_guard lock(mutex_);
  epoch_ = std::max(epoch_, at_least);
}

void HaltPath::renew() {
  const std::lock_guard lock(mutex_);
  is_renewed_ = true;
}

Instant HaltPath::next_wake() const {
  return pending_ ? next_try_ : next_beat_;
}

void HaltPath::run() {
  std::unique_lock lock(mutex_);
  while (!is_closing_) {
    const Duration left = next_wake() - clock_.now();
    if (left > Duration::zero()) {
      wake_.wait_for(lock, std::min(left, kLongestWait));
    } else if (pending_) {
      deliver(lock);
    } else {
      feed(lock);
    }
  }
  if (pending_) deliver(lock);
}

// No beat is fed while a halt is not delivered: if it never is, the stage stops by itself.
void HaltPath::deliver(std::unique_lock<std::mutex>& lock) {
  const Pending halt = *pending_;
  lock.unlock();
  const Result<void> outcome = line_.halt(halt.epoch);
  const Instant now = clock_.now();
  lock.lock();
  const bool is_news = outcome.has_value() || !has_failed_;
  has_failed_ = !outcome.has_value();
  if (outcome && pending_->epoch == halt.epoch) {
    pending_.reset();
  } else {
    next_try_ = outcome ? now : now + config_.retry;
  }
  if (is_news) {
    lock.unlock();
    report_(HaltReport{halt.epoch, halt.who, outcome, now - halt.asked});
    lock.lock();
  }
  report_line(lock, outcome);
}

void HaltPath::feed(std::unique_lock<std::mutex>& lock) {
  const Duration between =
      config_.heartbeat_timeout > Duration::zero() ? config_.heartbeat_timeout / kBeatsPerTimeout : kLongestWait;
  next_beat_ = clock_.now() + between;
  if (!is_renewed_ && is_up_) return;  // the very first beat opens the line, before the engine has had time to begin
  is_renewed_ = false;
  is_feeding_ = true;
  lock.unlock();
  Result<void> outcome = line_.watch_heartbeat(config_.heartbeat_timeout);
  if (outcome) outcome = line_.beat();
  lock.lock();
  is_feeding_ = false;
  // A beat that gave way to a STOP says nothing about the line.
  if (!pending_ && !is_closing_) report_line(lock, outcome);
}

void HaltPath::report_line(std::unique_lock<std::mutex>& lock, const Result<void>& outcome) {
  const bool is_up = outcome.has_value();
  if (is_up_ == is_up) return;
  is_up_ = is_up;
  lock.unlock();
  report_(HaltLineReport{is_up, is_up ? std::nullopt : std::optional<Error>(outcome.error())});
  lock.lock();
}

}  // namespace gonio::daemon
