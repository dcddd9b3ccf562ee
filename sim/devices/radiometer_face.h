#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "base/clock.h"
#include "protocol/usbtmc/scpi.h"
#include "sim/devices/radiometer_fault.h"
#include "sim/devices/radiometer_model.h"

namespace gonio::sim {

/// The radiometer as its SCPI commands show it: IEEE 488.2 common commands, headers in short and long form, compound
/// messages. A query that takes time holds up what follows in its message; a zero holds up only *OPC?.
/// Threads: one at a time, as the instrument.
class RadiometerFace {
 public:
  /// `model` must outlive it.
  explicit RadiometerFace(RadiometerModel& model) : model_(model) {}

  /// One whole message. A reply to an earlier one that nobody fetched is lost, with an entry in the error queue.
  void execute(std::string_view message, Instant now);
  /// Lets finish what is due.
  void advance_to(Instant now);
  /// When what is under way ends.
  [[nodiscard]] std::optional<Instant> due() const { return model_.due(); }

  /// What there is to be said, line end included; empty while its message is still worked on.
  [[nodiscard]] const std::string& output() const { return output_; }
  /// Takes its first bytes.
  [[nodiscard]] std::string take_output(std::size_t bytes);
  /// For faults: there is this to be said.
  void say_again(std::string_view text) { output_ = text; }
  /// For faults: the next sample says no value.
  void spoil_next_sample(RadiometerFault fault) { next_sample_ = fault; }
  /// A reply is about to be sent: the fault that strikes it.
  [[nodiscard]] std::optional<FaultKind> strike_reply(Instant now) { return model_.strike(FaultMoment::Reply, now); }
  [[nodiscard]] bool is_unplugged(Instant now) const { return model_.is_unplugged(now); }

  [[nodiscard]] std::uint8_t status_byte() const;
  /// Device clear: drops input, output and what is under way; settings and error queue stay.
  void clear();
  void power_up();

 private:
  enum class Waiting : std::uint8_t { Nothing, Sample, Zero };
  void run_units(Instant now);
  void run(std::string_view header, std::string_view argument, Instant now);
  bool act(std::string_view header, Instant now);
  bool set(std::string_view header, std::string_view argument, Instant now);
  bool answer(std::string_view header);
  [[nodiscard]] bool set_number(std::string_view header, double value, Instant now);
  void set_unit(std::string_view argument);
  void begin_sample(Instant now);
  void say(std::string_view text);
  void say_sample(const RadiometerSample& sample, Instant now);
  void add_error(int code, std::string_view text);
  [[nodiscard]] std::string take_error();

  RadiometerModel& model_;
  std::deque<std::string> units_;  ///< of the message under way
  std::string path_;               ///< where headers without a leading colon go on (SCPI-99, volume 1, 6.2.4)
  std::string reply_;              ///< of the message under way
  std::string output_;
  std::deque<scpi::ErrorEntry> errors_;
  Waiting waiting_ = Waiting::Nothing;
  bool is_zeroing_ = false;
  bool is_in_dbm_ = false;
  std::optional<RadiometerFault> next_sample_;  ///< what spoils it
};

}  // namespace gonio::sim
