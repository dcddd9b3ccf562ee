#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "drivers/links/modbus_link.h"

namespace gonio::drivers::test {

/// A Modbus unit of 256 registers that obeys, unless the script says otherwise for the next transaction.
class ScriptedModbusLink final : public ModbusLink {
 public:
  enum class Next : std::uint8_t {
    Obey,
    LoseRequest,  ///< nothing arrives, the caller times out
    LoseReply,    ///< it is done, the caller times out
    StaleReply,   ///< it is done, the caller gets the reply to the FC23 before
    Exception,    ///< refused by the unit
    Break,        ///< the connection breaks
  };
  struct Write {
    std::uint16_t first;
    std::vector<std::uint16_t> words;
  };

  Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override {
    return transact([&] { copy_out(first, into); });
  }

  Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override {
    return transact([&] { copy_in(first, words); });
  }

  Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words, std::uint16_t read_first,
                              std::span<std::uint16_t> into) override {
    const bool stale = !script.empty() && script.front() == Next::StaleReply;
    auto done = transact([&] {
      copy_in(write_first, words);
      copy_out(read_first, into);
    });
    if (stale && done) std::copy_n(last_read_.begin(), into.size(), into.begin());
    last_read_.assign(into.begin(), into.end());
    return done;
  }

  void resync() override { ++resyncs; }
  void interrupt() override { ++interrupts; }

  /// The writes to `first`, oldest first.
  [[nodiscard]] std::vector<std::vector<std::uint16_t>> writes_to(std::uint16_t first) const {
    std::vector<std::vector<std::uint16_t>> found;
    for (const Write& write : writes) {
      if (write.first == first) found.push_back(write.words);
    }
    return found;
  }

  std::array<std::uint16_t, 256> registers{};
  std::deque<Next> script;
  std::vector<Write> writes;  ///< those that arrived
  std::function<void(const Write&)> on_write = [](const Write&) {};
  int transactions = 0;
  int resyncs = 0;
  int interrupts = 0;

 private:
  template <class Act>
  Result<void> transact(Act act) {
    ++transactions;
    const Next next = script.empty() ? Next::Obey : script.front();
    if (!script.empty()) script.pop_front();
    const auto failed = [](ErrorCode code, std::string seen) {
      return failure({.code = code, .device = "stage", .tried = "talk", .seen = std::move(seen)});
    };
    if (next == Next::Exception) return failed(ErrorCode::DeviceRefused, "illegal data value");
    if (next == Next::Break) return failed(ErrorCode::Unreachable, "connection reset");
    if (next == Next::LoseRequest) return failed(ErrorCode::TimedOut, "no reply");
    act();
    if (next == Next::LoseReply) return failed(ErrorCode::TimedOut, "no reply");
    return {};
  }

  void copy_in(std::uint16_t first, std::span<const std::uint16_t> words) {
    std::copy(words.begin(), words.end(), registers.begin() + first);
    writes.push_back({first, {words.begin(), words.end()}});
    on_write(writes.back());
  }

  void copy_out(std::uint16_t first, std::span<std::uint16_t> into) const {
    std::copy_n(registers.begin() + first, into.size(), into.begin());
  }

  std::vector<std::uint16_t> last_read_ = std::vector<std::uint16_t>(125);
};

}  // namespace gonio::drivers::test
