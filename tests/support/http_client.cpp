#include "tests/support/http_client.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

namespace gonio::test {
namespace {

using Steady = std::chrono::steady_clock;

int connect_to(int port) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (fd >= 0 && connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  if (fd >= 0) close(fd);
  return -1;
}

bool send_all(int fd, const std::string& text) {
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t n = send(fd, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

// Appends what arrives; false when the peer has closed or the deadline has passed.
bool receive(int fd, std::string& text, Steady::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Steady::now()).count();
  pollfd waiting{fd, POLLIN, 0};
  if (left <= 0 || poll(&waiting, 1, static_cast<int>(left)) <= 0) return false;
  char buffer[16384];
  const ssize_t n = recv(fd, buffer, sizeof buffer, 0);
  if (n <= 0) return false;
  text.append(buffer, static_cast<std::size_t>(n));
  return true;
}

HttpAnswer parse_head(const std::string& head) {
  HttpAnswer answer;
  std::istringstream lines(head);
  std::string line;
  std::getline(lines, line);
  if (line.size() > 12) answer.status = std::atoi(line.c_str() + 9);
  while (std::getline(lines, line)) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    std::string name = line.substr(0, colon);
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::string value = line.substr(std::min(line.size(), colon + 2));
    while (!value.empty() && (value.back() == '\r' || value.back() == ' ')) value.pop_back();
    answer.headers[name] = value;
  }
  return answer;
}

std::string without_chunks(const std::string& body) {
  std::string text;
  std::size_t at = 0;
  while (at < body.size()) {
    const std::size_t end = body.find("\r\n", at);
    if (end == std::string::npos) break;
    const std::size_t size = std::strtoul(body.c_str() + at, nullptr, 16);
    if (size == 0) break;
    text += body.substr(end + 2, size);
    at = end + 2 + size + 2;
  }
  return text;
}

}  // namespace

HttpAnswer http_request(int port, const std::string& method, const std::string& path, const std::string& body,
                        const std::map<std::string, std::string>& headers, std::chrono::seconds deadline) {
  const int fd = connect_to(port);
  if (fd < 0) return {};
  std::ostringstream request;
  request << method << ' ' << path << " HTTP/1.1\r\nConnection: close\r\n";
  if (!headers.contains("Host")) request << "Host: 127.0.0.1:" << port << "\r\n";
  if (!body.empty() && !headers.contains("Content-Type")) request << "Content-Type: application/json\r\n";
  for (const auto& [name, value] : headers) request << name << ": " << value << "\r\n";
  if (!body.empty() || method != "GET") request << "Content-Length: " << body.size() << "\r\n";
  request << "\r\n" << body;
  std::string text;
  if (send_all(fd, request.str())) {
    const auto end = Steady::now() + deadline;
    while (receive(fd, text, end)) {
    }
  }
  close(fd);
  const std::size_t split = text.find("\r\n\r\n");
  if (split == std::string::npos) return {};
  HttpAnswer answer = parse_head(text.substr(0, split));
  answer.body = text.substr(split + 4);
  if (answer.headers["transfer-encoding"] == "chunked") answer.body = without_chunks(answer.body);
  return answer;
}

EventReader::EventReader(int port, long after) : thread_([this, port, after] { read(port, after); }) {}

EventReader::~EventReader() {
  stop_ = true;
  thread_.join();
}

std::vector<ServerEvent> EventReader::events() const {
  const std::lock_guard lock(mutex_);
  return events_;
}

long EventReader::last_number() const {
  const std::lock_guard lock(mutex_);
  return events_.empty() ? 0 : events_.back().number;
}

bool EventReader::wait_for(const std::function<bool(const std::vector<ServerEvent>&)>& condition,
                           std::chrono::milliseconds deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, deadline, [&] { return ended_ || condition(events_); });
  return condition(events_);
}

void EventReader::read(int port, long after) {
  const int fd = connect_to(port);
  // HTTP/1.0: the answer comes without chunks, so that an event is never cut by a chunk's size line.
  std::string request = "GET /api/v1/events HTTP/1.0\r\nHost: 127.0.0.1:" + std::to_string(port) +
                        "\r\nAccept: text/event-stream\r\nLast-Event-ID: " + std::to_string(after) + "\r\n\r\n";
  std::string text;
  if (fd >= 0 && send_all(fd, request)) {
    connected_ = true;
    while (!stop_) {
      pollfd waiting{fd, POLLIN, 0};
      if (poll(&waiting, 1, 20) == 0) continue;
      if (!receive(fd, text, Steady::now() + std::chrono::seconds(1))) break;
      for (std::size_t end; (end = text.find("\n\n")) != std::string::npos; text.erase(0, end + 2)) {
        take(text.substr(0, end));
      }
    }
  }
  if (fd >= 0) close(fd);
  const std::lock_guard lock(mutex_);
  connected_ = false;
  ended_ = true;
  changed_.notify_all();
}

void EventReader::take(const std::string& block) {
  ServerEvent event;
  std::istringstream lines(block);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("id: ", 0) == 0) event.number = std::atol(line.c_str() + 4);
    if (line.rfind("event: ", 0) == 0) event.kind = line.substr(7);
    if (line.rfind("data: ", 0) == 0) event.data += line.substr(6);
  }
  if (event.number == 0) return;
  const std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
  changed_.notify_all();
}

}  // namespace gonio::test
