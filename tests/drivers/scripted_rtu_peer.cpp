#include "tests/drivers/scripted_rtu_peer.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <termios.h>
#include <unistd.h>

#include <utility>

namespace gonio::drivers::test {
namespace {

// Of the functions that the stage uses: 3, 6, 16, 23. 0: not known yet.
std::size_t length_of(const Bytes& begin) {
  if (begin.size() < 2) return 0;
  if (begin[1] == 3 || begin[1] == 4 || begin[1] == 6) return 8;
  const std::size_t count_at = begin[1] == 16 ? 6 : 10;
  return begin.size() > count_at ? count_at + 1 + begin[count_at] + 2 : 0;
}

}  // namespace

Bytes with_crc(Bytes unit_and_pdu) {
  unsigned crc = 0xFFFF;
  for (const unsigned byte : unit_and_pdu) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0xA001U : crc >> 1U;
  }
  unit_and_pdu.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  unit_and_pdu.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return unit_and_pdu;
}

ScriptedRtuPeer::ScriptedRtuPeer(Script script) : script_(std::move(script)) {
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  wake_ = eventfd(0, EFD_CLOEXEC);
  if (grantpt(master_) != 0 || unlockpt(master_) != 0) return;
  char name[128];
  if (ptsname_r(master_, name, sizeof name) != 0) return;
  device_ = name;
  slave_ = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  tcgetattr(slave_, &settings);
  cfmakeraw(&settings);
  tcsetattr(slave_, TCSANOW, &settings);
  thread_ = std::thread([this] { serve(); });
}

ScriptedRtuPeer::~ScriptedRtuPeer() {
  eventfd_write(wake_, 1);
  if (thread_.joinable()) thread_.join();
  for (const int fd : {slave_, master_, wake_}) close(fd);
}

std::vector<Bytes> ScriptedRtuPeer::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}

void ScriptedRtuPeer::wait_for_requests(std::size_t count) const {
  std::unique_lock lock(mutex_);
  came_.wait(lock, [&] { return requests_.size() >= count; });
}

void ScriptedRtuPeer::say(const Bytes& bytes) const {
  if (!bytes.empty()) [[maybe_unused]]
    const ssize_t n = write(master_, bytes.data(), bytes.size());
}

void ScriptedRtuPeer::serve() {
  Bytes received;
  for (;;) {
    pollfd both[2] = {{master_, POLLIN, 0}, {wake_, POLLIN, 0}};
    if (poll(both, 2, -1) < 0 || (both[1].revents & POLLIN) != 0) return;
    std::uint8_t part[512];
    const ssize_t n = read(master_, part, sizeof part);
    if (n <= 0) return;
    received.insert(received.end(), part, part + n);
    for (std::size_t length = length_of(received); length != 0 && received.size() >= length;
         length = length_of(received)) {
      const auto end = received.begin() + static_cast<std::ptrdiff_t>(length);
      const Bytes request(received.begin(), end);
      received.erase(received.begin(), end);
      const Bytes reply = script_(request, requests().size());
      {
        const std::lock_guard lock(mutex_);
        requests_.push_back(request);  // first: whoever has the reply may ask for the request
      }
      say(reply);
      came_.notify_all();
    }
  }
}

}  // namespace gonio::drivers::test
