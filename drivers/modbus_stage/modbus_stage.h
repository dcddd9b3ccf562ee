#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "drivers/links/modbus_link.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// The stage of `protocol/stage` over a Modbus link.
///
/// Every look is one FC23 that writes a fresh token and reads the whole status block: a reply without that token
/// belongs to another request and is thrown away with all the line still holds. Identity and map version are checked at
/// every look. Tries of one call are at most `kTries`; an exception reply is not tried again. A motion command is
/// written once more only after a look has shown that it did not arrive.
///
/// A stage that has left everything unanswered for the heartbeat's timeout has stopped by itself: from then on a call
/// fails with Unreachable instead of TimedOut, and is tried once. The first answer ends that.
class ModbusStage final : public Stage {
 public:
  static constexpr int kTries = 3;

  /// `link`, `config` and `clock` must outlive the stage.
  ModbusStage(ModbusLink& link, const StageConfig& config, const Clock& clock);

  Result<StageState> read_state() override;
  Result<MotionToken> start_move(const MotionTarget& target, Epoch epoch) override;
  Result<StartedMove> start_move_and_look(const MotionTarget& target, Epoch epoch) override;
  Result<MotionToken> start_homing(Epoch epoch) override;
  Result<void> set_shutters(bool source_open, bool detector_open) override;
  Result<void> reset(Epoch epoch) override;

 private:
  /// The exchange that `exchange` makes, with what it tells of the stage's silence.
  template <class Exchange>
  [[nodiscard]] Result<void> talk(Exchange exchange);
  [[nodiscard]] bool has_been_silent_too_long() const;
  [[nodiscard]] bool is_worth_another_try(const Error& error) const;
  [[nodiscard]] Result<StageState> look_once();
  [[nodiscard]] Result<MotionToken> fresh_motion_token();
  [[nodiscard]] std::vector<std::uint16_t> move_words(const MotionTarget& target, Epoch epoch, MotionToken token) const;
  [[nodiscard]] std::optional<StageState> shown_by(std::span<const std::uint16_t> words, MotionToken token);
  [[nodiscard]] Result<MotionToken> send_motion(std::vector<std::uint16_t> words, MotionToken token,
                                                const std::string& tried);
  /// After a command whose reply is missing.
  [[nodiscard]] Result<MotionToken> send_again(std::vector<std::uint16_t> words, MotionToken token,
                                               const std::string& tried);
  [[nodiscard]] Result<void> write_again(std::uint16_t first, const std::vector<std::uint16_t>& words,
                                         const std::string& tried);

  ModbusLink& link_;
  const StageConfig& config_;
  const Clock& clock_;
  /// The motion tokens that the stage showed at the last look.
  struct ShownTokens {
    MotionToken accepted = 0;
    MotionToken refused = 0;
  };
  std::optional<ShownTokens> shown_;
  std::optional<Instant> silent_since_;  ///< when the first exchange without an answer began
  std::uint16_t token_ = 0;              ///< of the last look
  MotionToken motion_token_ = 0;         ///< of the last motion command
};

}  // namespace gonio::drivers
