#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/clock.h"
#include "drivers/drive_stage/drive_latch.h"
#include "drivers/drive_stage/drive_links.h"
#include "drivers/drive_stage/drive_unit.h"
#include "drivers/drive_stage/io_coupler.h"
#include "drivers/stage.h"
#include "drivers/stage_config.h"

namespace gonio::drivers {

/// A stage of one ready-made drive an axis and a coupler (`StageConfig::drives`), none of which knows tokens, epochs or
/// an exposure's gate: those are kept here. A refusal of this object's own is shown as a stage's is: `refused_token`
/// and `refusal` of the next state.
///
/// The boot counter counts what is seen of losses of power: a homed bit that went out without a homing of ours, or a
/// boot_check register that lost its value. Each is followed by Setup. The gate of a state is always empty.
class DriveStage final : public Stage {
 public:
  /// `links` are of this thread; `config.drives` must be set. All must outlive it.
  DriveStage(const DriveLinks& links, const StageConfig& config, DriveLatch& latch, const Clock& clock);
  ~DriveStage() override;

  Result<StageState> read_state() override;
  /// Axes that were told to stand where they stand are told nothing. Errors: also DeviceRefused (an awaited state did
  /// not come); what had begun to move then is halted.
  Result<MotionToken> start_move(const MotionTarget& target, Epoch epoch) override;
  Result<MotionToken> start_homing(Epoch epoch) override;
  Result<void> set_shutters(bool source_open, bool detector_open) override;
  /// Errors: also DeviceRefused (the epoch is older than the halt's).
  Result<void> reset(Epoch epoch) override;

 private:
  struct Drive;
  [[nodiscard]] Result<void> meet(Drive& drive);
  [[nodiscard]] Result<DriveLook> look_at(Drive& drive);
  [[nodiscard]] Result<void> check_power(Drive& drive, const DriveLook& look);
  [[nodiscard]] Result<std::int64_t> plausible(Drive& drive, std::int64_t counts);
  void show(const Drive& drive, const DriveLook& look, StageState& state) const;
  void show_latch(StageState& state) const;
  [[nodiscard]] Result<stage::Refusal> judge(Epoch epoch, const MotionTarget* target);
  MotionToken refuse(MotionToken token, stage::Refusal refusal);
  [[nodiscard]] MotionToken fresh_token();
  [[nodiscard]] Result<MotionToken> conclude(MotionToken token, Epoch epoch, Result<void> told);
  [[nodiscard]] Result<void> tell_move(const MotionTarget& target, Epoch epoch);
  [[nodiscard]] Result<void> tell_home(Epoch epoch);
  [[nodiscard]] bool is_there(const Drive& drive, double target) const;
  void halt_what_moves();

  const StageConfig& config_;
  DriveLatch& latch_;
  const Clock& clock_;
  stage::PerAxis<std::unique_ptr<Drive>> drives_;  ///< null: the axis is fixed
  std::unique_ptr<UnitLine> io_line_;
  std::unique_ptr<IoCoupler> io_;
  std::size_t next_checked_ = 0;  ///< whose boot_check is looked at next: one a look
  std::uint32_t boot_counter_ = 1;
  MotionToken token_ = 0;
  MotionToken accepted_token_ = 0;
  MotionToken refused_token_ = 0;
  stage::Refusal refusal_ = stage::Refusal::None;
  std::optional<StageState> last_;
};

}  // namespace gonio::drivers
