#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "base/clock.h"
#include "drivers/links/usbtmc_link.h"

namespace gonio::drivers::test {

/// What goes wrong with the next reply, or with the next command.
enum class Fault { None, Silence, Stall, StallsCommand, Torn, StaleTag, WrongInverse, Twice };

/// A USBTMC device of a few lines, which keeps what is set and says it when asked: its bytes are laid out here by hand,
/// not by the code under test. What never comes lets the clock pass the timeout, as waiting does.
class ScriptedMeter final : public UsbtmcLink {
 public:
  explicit ScriptedMeter(ManualClock& clock) : clock_(clock) {}

  Result<DetectorIdentity> open() override;
  void close() override { is_open_ = false; }
  bool is_open() const override { return is_open_; }
  UsbtmcInterface interface() const override {
    return {.number = 0,
            .bulk_out = 0x01,
            .bulk_in = 0x82,
            .interrupt_in = static_cast<std::uint8_t>(has_interrupt_in ? 0x83 : 0)};
  }
  Result<void> bulk_out(std::span<const std::uint8_t> bytes, Duration timeout) override;
  Result<std::vector<std::uint8_t>> bulk_in(std::size_t most, Duration timeout) override;
  Result<std::vector<std::uint8_t>> interrupt_in(Duration timeout) override;
  Result<std::vector<std::uint8_t>> control_in(const usbtmc::ControlRequest& request, Duration timeout) override;
  Result<void> clear_halt(std::uint8_t endpoint) override;

  bool has_interrupt_in = false;
  std::map<std::string, std::string> answers;  ///< to a query: said instead of what was set
  std::map<std::string, std::string> kept;     ///< by header: what was set
  std::map<std::string, std::string> refused;  ///< by command: the entry that it leaves in the error queue
  std::deque<std::string> samples;             ///< of READ?, the last one for ever
  std::deque<std::string> errors;
  Duration sample_time{};  ///< of READ?
  Fault fault = Fault::None;
  std::size_t bytes_in_a_transfer = 1024;  ///< longer replies come in parts
  bool is_gone = false;
  bool clears_slowly = false;
  bool refuses_to_clear = false;

  int opens = 0;
  int clears = 0;
  int aborts = 0;
  std::vector<std::uint8_t> halts_cleared;
  std::vector<std::string> heard;

 private:
  [[nodiscard]] Result<void> there() const;
  void hear(const std::string& line);
  void empty();
  [[nodiscard]] std::uint8_t status() const;
  [[nodiscard]] std::vector<std::uint8_t> transfer();

  ManualClock& clock_;
  bool is_open_ = false;
  std::string output_;    ///< what there is to be said
  Instant output_at_{};   ///< from when on
  std::uint8_t tag_ = 0;  ///< of the request that waits; 0: none
  int checks_ = 0;        ///< of a clear
  std::deque<std::vector<std::uint8_t>> notifications_;
};

}  // namespace gonio::drivers::test
