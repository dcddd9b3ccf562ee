#include "tests/support/discrete_executor.h"

#include <algorithm>
#include <utility>

namespace gonio::test {
namespace {

constexpr int kMostRoundsAtOneInstant = 10000;

}  // namespace

void DiscreteExecutor::add(std::string name, Step step) {
  parties_.push_back({std::move(name), std::move(step), clock_.now()});
}

void DiscreteExecutor::deliver_all() {
  // Mail posted by a delivery waits for the next round, so that two actors that answer each other cannot hide in here.
  for (std::size_t waiting = mail_.size(); waiting > 0; --waiting) {
    const Delivery delivery = std::move(mail_.front());
    mail_.pop_front();
    delivery(clock_.now());
  }
}

void DiscreteExecutor::step_all() {
  for (Party& party : parties_) party.wake = party.step(clock_.now());
}

std::optional<Instant> DiscreteExecutor::earliest_wake() const {
  std::optional<Instant> earliest;
  for (const Party& party : parties_) {
    if (party.wake && (!earliest || *party.wake < *earliest)) earliest = party.wake;
  }
  return earliest;
}

DiscreteExecutor::Outcome DiscreteExecutor::run_until(const std::function<bool()>& reached, Duration limit) {
  const Instant end = clock_.now() + limit;
  for (int rounds = 0; rounds < kMostRoundsAtOneInstant; ++rounds) {
    deliver_all();
    step_all();
    if (!mail_.empty()) continue;
    if (reached()) return Outcome::Reached;
    const std::optional<Instant> wake = earliest_wake();
    if (!wake) return Outcome::Idle;
    if (*wake > end) {
      clock_.advance_to(end);
      return Outcome::TimeUp;
    }
    if (*wake > clock_.now()) rounds = 0;
    clock_.advance_to(*wake);
  }
  return Outcome::Spinning;
}

void DiscreteExecutor::run_for(Duration time) {
  const Instant end = clock_.now() + time;
  static_cast<void>(run_until([] { return false; }, time));
  clock_.advance_to(end);
}

std::string DiscreteExecutor::describe() const {
  std::string text = std::to_string(mail_.size()) + " letters";
  for (const Party& party : parties_) {
    text += ", " + party.name;
    if (!party.wake) {
      text += " asleep";
      continue;
    }
    text += " wants +" + std::to_string(in_seconds(*party.wake - clock_.now())) + " s";
  }
  return text;
}

}  // namespace gonio::test
