#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/drivers/scripted_modbus_server.h"

namespace gonio::drivers::test {

/// The other end of a serial line, as a pseudo terminal, written from the specification alone (Modbus over Serial Line
/// V1.02): each whole request is handed to the script, whose bytes go back as they are.
class ScriptedRtuPeer {
 public:
  /// `request` is the whole frame; `index` counts from 0. Runs on the peer's thread.
  using Script = std::function<Bytes(const Bytes& request, std::size_t index)>;

  explicit ScriptedRtuPeer(Script script);
  ~ScriptedRtuPeer();

  [[nodiscard]] std::string device() const { return device_; }
  [[nodiscard]] std::vector<Bytes> requests() const;
  /// Returns when so many requests have been answered by the script.
  void wait_for_requests(std::size_t count) const;
  /// Bytes on the line, now.
  void say(const Bytes& bytes) const;

 private:
  void serve();

  Script script_;
  std::string device_;
  int master_ = -1;
  int slave_ = -1;
  int wake_ = -1;
  mutable std::mutex mutex_;
  mutable std::condition_variable came_;
  std::vector<Bytes> requests_;
  std::thread thread_;
};

/// The frame of unit and PDU with their CRC (Modbus over Serial Line V1.02, appendix B).
[[nodiscard]] Bytes with_crc(Bytes unit_and_pdu);

}  // namespace gonio::drivers::test
