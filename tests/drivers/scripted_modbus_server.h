#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace gonio::drivers::test {

using Bytes = std::vector<std::uint8_t>;

/// "00 ff 1a" as bytes.
[[nodiscard]] Bytes bytes(const std::string& hex);

/// One side of a Modbus TCP conversation, written from the specification alone (MODBUS Messaging on TCP/IP V1.0b): one
/// client at a time, each request handed to the script, whose bytes go back as they are.
class ScriptedModbusServer {
 public:
  struct Answer {
    Bytes reply;          ///< empty: none
    bool closes = false;  ///< the connection, after the reply
  };
  /// `request` is the whole frame; `connection` counts from 0. Runs on the server's thread.
  using Script = std::function<Answer(const Bytes& request, int connection)>;

  explicit ScriptedModbusServer(Script script);
  ~ScriptedModbusServer();

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::vector<Bytes> requests() const;
  [[nodiscard]] int connections() const;
  /// Returns when the server has seen so many requests.
  void wait_for_requests(std::size_t count) const;

 private:
  void serve();
  void converse(int client);

  Script script_;
  int listener_ = -1;
  int wake_ = -1;
  std::uint16_t port_ = 0;
  mutable std::mutex mutex_;
  std::vector<Bytes> requests_;
  int connections_ = 0;
  std::thread thread_;
};

/// A reply frame: the request's transaction and unit, then `pdu`.
[[nodiscard]] Bytes reply_to(const Bytes& request, const Bytes& pdu);

}  // namespace gonio::drivers::test
