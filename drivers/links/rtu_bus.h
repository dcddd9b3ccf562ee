#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "drivers/links/modbus_link.h"
#include "drivers/links/rtu_line.h"

namespace gonio::drivers {

/// One Modbus RTU line for several threads: three ways to it, which differ in who waits for whom.
///
/// A call on `urgent` waits for nobody: the exchange in progress gives way (its call fails with Unreachable, and is
/// never taken for done), the line is let become quiet, and the frame goes out, 35 ms after the call at the latest. A
/// call on `prompt` is the next in turn and interrupts nobody. Each face is a ModbusLink of its own for one thread;
/// `interrupt` ends the face's own call, or its next one. Opens the line on the first call, and anew after it broke.
/// A call waits for its turn for three exchanges at most, then fails with TimedOut.
class RtuBus {
 public:
  enum class Rank : std::uint8_t { Normal, Prompt, Urgent };

  explicit RtuBus(RtuLineConfig config);
  RtuBus(const RtuBus&) = delete;
  RtuBus& operator=(const RtuBus&) = delete;

  [[nodiscard]] ModbusLink& normal() { return normal_; }
  [[nodiscard]] ModbusLink& prompt() { return prompt_; }
  [[nodiscard]] ModbusLink& urgent() { return urgent_; }
  /// A way of that rank to another unit on the line, for one thread; the bus must outlive it.
  [[nodiscard]] std::unique_ptr<ModbusLink> for_unit(Rank rank, const ModbusUnit& unit);

 private:
  class Face final : public ModbusLink {
   public:
    Face(RtuBus& bus, Rank rank, const ModbusUnit& unit) : bus_(bus), rank_(rank), unit_(unit) {}
    Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override;
    Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override;
    Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                std::uint16_t read_first, std::span<std::uint16_t> into) override;
    void resync() override;
    void interrupt() override;

   private:
    friend class RtuBus;
    [[nodiscard]] Result<void> transact(std::string tried, const ModbusRequest& request, std::span<std::uint16_t> into);
    RtuBus& bus_;
    const Rank rank_;
    const ModbusUnit unit_;
    std::atomic<bool> is_interrupted_{false};
    std::size_t last_reply_bytes_ = 0;
  };

  [[nodiscard]] Result<void> take_turn(Face& face);
  void give_turn();
  [[nodiscard]] bool may_begin(Rank rank) const;
  [[nodiscard]] std::atomic<int>& waiting(Rank rank) { return waiting_[static_cast<std::size_t>(rank)]; }

  RtuLine line_;  ///< whoever has the turn
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_taken_ = false;
  std::array<std::atomic<int>, 3> waiting_{};  ///< by rank; written under the mutex, read by who has the turn
  Face normal_{*this, Rank::Normal, {.unit_id = line_.unit_id()}};
  Face prompt_{*this, Rank::Prompt, {.unit_id = line_.unit_id()}};
  Face urgent_{*this, Rank::Urgent, {.unit_id = line_.unit_id()}};
};

}  // namespace gonio::drivers
