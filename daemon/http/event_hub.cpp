#include "daemon/http/event_hub.h"

#include <algorithm>

#include "protocol/api/event_stream_format.h"

namespace gonio::daemon {
namespace {

constexpr int kFetchedAtOnce = 200;
constexpr std::size_t kMostReadsWaiting = 1024;  // more than there can be connections

}  // namespace

EventHub::EventHub(Fetch fetch, std::int64_t last, std::size_t client_limit_bytes)
    : fetch_(std::move(fetch)), client_limit_bytes_(client_limit_bytes), last_(last), worker_(kMostReadsWaiting) {}

void EventHub::publish(const api::Event& event) {
  const auto text = std::make_shared<const std::string>(api::to_event_stream(event));
  std::vector<std::shared_ptr<EventClient>> behind;
  {
    const std::lock_guard lock(mutex_);
    last_ = std::max(last_, event.number);
    ++published_;
    for (const auto& client : clients_) {
      if (!client->offer(event.number, text)) behind.push_back(client);
    }
    forget_closed();
  }
  for (const auto& client : behind) catch_up(client);
}

std::shared_ptr<EventClient> EventHub::listen(std::optional<std::int64_t> after, ConnectionHooks hooks) {
  std::shared_ptr<EventClient> client;
  {
    const std::lock_guard lock(mutex_);
    const std::int64_t from = std::min(after.value_or(last_), last_);
    client = std::make_shared<EventClient>(from, from == last_, client_limit_bytes_, std::move(hooks));
    clients_.push_back(client);
    if (closed_) client->drop();
  }
  catch_up(client);
  return client;
}

void EventHub::catch_up(const std::shared_ptr<EventClient>& client) {
  if (!client->begin_fetch()) return;
  if (worker_.post([this, client] { fetch_for(client); })) return;
  client->drop();
}

void EventHub::fetch_for(const std::shared_ptr<EventClient>& client) {
  for (;;) {
    const Result<std::vector<api::Event>> events = fetch_(client->last(), kFetchedAtOnce);
    if (!events) {
      client->drop();
      return;
    }
    for (const api::Event& event : *events) client->add_fetched(event.number, api::to_event_stream(event));
    const std::lock_guard lock(mutex_);  // nothing is published between the look and going live
    const bool has_all = client->last() >= last_;
    // An empty answer that is behind the published number would loop for ever: such a store has lost events.
    if (!has_all && events->empty()) client->drop();
    if (has_all || events->empty() || !client->has_room()) {
      client->end_fetch(has_all);
      return;
    }
  }
}

void EventHub::keep_alive() {
  const std::lock_guard lock(mutex_);
  for (const auto& client : clients_) client->keep_alive();
  forget_closed();
}

void EventHub::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (const auto& client : clients_) client->drop();
}

std::size_t EventHub::clients() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

void EventHub::forget_closed() {
  std::erase_if(clients_, [this](const auto& client) {
    if (client->was_dropped()) ++dropped_;
    return !client->is_open();
  });
}

}  // namespace gonio::daemon
