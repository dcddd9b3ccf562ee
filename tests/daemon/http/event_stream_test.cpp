// Events over a real loopback socket: each once, in order, from any number on, whatever the client does.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/http/server.h"
#include "protocol/api/event_stream_format.h"
#include "tests/daemon/http/fake_service.h"
#include "tests/support/http_client.h"
#include "tests/support/process.h"

namespace gonio::daemon {
namespace {

using test::EventReader;
using test::ServerEvent;

constexpr std::chrono::seconds kHanging{60};

class EventStream : public testing::Test {
 protected:
  void start(const ServerOptions& options = {}) {
    Result<Listeners> bound = Listeners::bind("127.0.0.1", 0, "");
    ASSERT_TRUE(bound.has_value()) << describe(bound.error());
    Result<std::unique_ptr<Server>> started = Server::start(std::move(*bound), options, service_, clock_);
    ASSERT_TRUE(started.has_value()) << describe(started.error());
    server_ = std::move(*started);
  }
  void commit_and_publish(int n) {
    for (int i = 0; i < n; ++i) server_->publish(service_.commit("item-accepted"));
  }
  static bool has(const std::vector<ServerEvent>& events, std::size_t n) { return events.size() >= n; }
  static void expect_numbers(const std::vector<ServerEvent>& events, long first, long last) {
    ASSERT_EQ(static_cast<long>(events.size()), last - first + 1);
    for (std::size_t i = 0; i < events.size(); ++i) EXPECT_EQ(events[i].number, first + static_cast<long>(i));
  }

  SystemClock clock_;
  test::FakeService service_;
  std::unique_ptr<Server> server_;
};

TEST_F(EventStream, SendsWhatIsPublished) {
  start();
  EventReader reader(server_->port(), 0);
  ASSERT_TRUE(test::eventually([&] { return reader.is_connected(); }, kHanging));

  server_->publish(service_.commit("item-accepted", R"({"point":4})"));

  ASSERT_TRUE(reader.wait_for([](const auto& e) { return has(e, 1); }, kHanging));
  const ServerEvent event = reader.events().front();
  EXPECT_EQ(event.number, 1);
  EXPECT_EQ(event.kind, "item-accepted");
  EXPECT_EQ(
      event.data,
      R"({"data":{"point":4},"kind":"item-accepted","kind_version":1,"number":1,"scan":3,"utc":"","who":"local"})");
}

TEST_F(EventStream, ResumesAfterTheLastEventWithoutGapOrDouble) {
  for (int i = 0; i < 1000; ++i) (void)service_.commit("item-accepted");
  start({.last_event = 1000});

  EventReader reader(server_->port(), 250);
  commit_and_publish(500);

  ASSERT_TRUE(reader.wait_for([](const auto& e) { return has(e, 1250); }, kHanging));
  expect_numbers(reader.events(), 251, 1500);
}

TEST_F(EventStream, GivesManyClientsWhoComeWhileEventsFlowEachEventOnce) {
  start();
  std::vector<std::unique_ptr<EventReader>> readers;
  for (int i = 0; i < 20; ++i) {
    commit_and_publish(50);
    readers.push_back(std::make_unique<EventReader>(server_->port(), 0));
  }
  commit_and_publish(50);

  for (const auto& reader : readers) {
    ASSERT_TRUE(reader->wait_for([](const auto& e) { return has(e, 1050); }, kHanging));
    expect_numbers(reader->events(), 1, 1050);
  }
}

TEST_F(EventStream, StartsFromNowWithoutALastEvent) {
  for (int i = 0; i < 10; ++i) (void)service_.commit("old");
  start({.last_event = 10});
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{.sin_family = AF_INET, .sin_port = htons(server_->port()), .sin_addr = {htonl(INADDR_LOOPBACK)}};
  ASSERT_EQ(connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const std::string request =
      "GET /api/v1/events HTTP/1.1\r\nHost: localhost:" + std::to_string(server_->port()) + "\r\n\r\n";
  ASSERT_EQ(write(fd, request.data(), request.size()), static_cast<ssize_t>(request.size()));
  std::string text;
  const auto read_until = [&](const std::string& words) {
    char buffer[4096];
    while (text.find(words) == std::string::npos) {
      const ssize_t n = read(fd, buffer, sizeof buffer);
      if (n <= 0) return false;
      text.append(buffer, static_cast<std::size_t>(n));
    }
    return true;
  };
  ASSERT_TRUE(read_until(": goniod"));

  commit_and_publish(1);

  EXPECT_TRUE(read_until("id: 11"));
  EXPECT_EQ(text.find("old"), std::string::npos);
  close(fd);
}

TEST_F(EventStream, AClientThatDoesNotReadIsBoundedThenDroppedAndDelaysNobody) {
  start({.event_client_limit_bytes = 64U << 10U});
  const int stuck = socket(AF_INET, SOCK_STREAM, 0);
  const int small = 2048;
  setsockopt(stuck, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  sockaddr_in address{.sin_family = AF_INET, .sin_port = htons(server_->port()), .sin_addr = {htonl(INADDR_LOOPBACK)}};
  ASSERT_EQ(connect(stuck, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const std::string request =
      "GET /api/v1/events HTTP/1.1\r\nHost: localhost:" + std::to_string(server_->port()) + "\r\n\r\n";
  ASSERT_EQ(write(stuck, request.data(), request.size()), static_cast<ssize_t>(request.size()));
  EventReader reader(server_->port(), 0);
  ASSERT_TRUE(test::eventually([&] { return reader.is_connected(); }, kHanging));

  const auto is_dropped = [&] {
    const std::string metrics = test::http_request(server_->port(), "GET", "/api/v1/metrics").body;
    return metrics.find("goniod_event_clients_dropped_total 1") != std::string::npos;
  };
  const std::string long_data = "{\"text\":\"" + std::string(4000, 'x') + "\"}";
  long published = 0;
  // A reader that keeps up is waited for, so that only the stuck one falls behind. 5000 x 4 kB exceed any socket
  // buffer.
  while (!is_dropped() && published < 5000) {
    server_->publish(service_.commit("item-accepted", long_data));
    ++published;
    ASSERT_TRUE(reader.wait_for([&](const auto& e) { return has(e, static_cast<std::size_t>(published)); }, kHanging));
  }

  EXPECT_TRUE(is_dropped()) << published << " events of 4 kB";
  expect_numbers(reader.events(), 1, published);
  close(stuck);
}

TEST_F(EventStream, AQuietStreamIsKeptAliveByComments) {
  start({.keep_alive = std::chrono::milliseconds(1)});
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{.sin_family = AF_INET, .sin_port = htons(server_->port()), .sin_addr = {htonl(INADDR_LOOPBACK)}};
  ASSERT_EQ(connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const std::string request =
      "GET /api/v1/events HTTP/1.1\r\nHost: localhost:" + std::to_string(server_->port()) + "\r\n\r\n";
  ASSERT_EQ(write(fd, request.data(), request.size()), static_cast<ssize_t>(request.size()));
  std::string text;
  char buffer[4096];
  while (text.find(": still here") == std::string::npos) {
    const ssize_t n = read(fd, buffer, sizeof buffer);
    ASSERT_GT(n, 0) << text;
    text.append(buffer, static_cast<std::size_t>(n));
  }
  close(fd);
}

TEST(EventStreamFormat, IsReadBackFromBytesCutAnywhere) {
  const api::Event event{
      .number = 12, .kind = "hold-added", .scan = 3, .who = "uid:1000", .data = R"({"name":"lamp"})"};
  const std::string text = ": comment\n\n" + api::to_event_stream(event) + api::to_event_stream(event);
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    api::EventStreamReader reader;
    std::vector<api::Event> events;
    for (const std::string& part : {text.substr(0, cut), text.substr(cut)}) {
      reader.feed(part);
      while (const auto next = reader.next()) events.push_back(*next);
    }
    ASSERT_EQ(events.size(), 2U) << "cut at " << cut;
    EXPECT_EQ(events[1].number, 12);
    EXPECT_EQ(events[1].data, R"({"name":"lamp"})");
  }
}

}  // namespace
}  // namespace gonio::daemon
