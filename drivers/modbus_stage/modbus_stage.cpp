#include "drivers/modbus_stage/modbus_stage.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "drivers/modbus_stage/stage_state_words.h"
#include "drivers/motion/move_task.h"

namespace gonio::drivers {
namespace {

using stage::AxisField;
using stage::Field;

// The words of one command, filled value by value.
class CommandWords {
 public:
  CommandWords(const stage::RegisterMap& map, stage::Block block) : map_(map), block_(block), words_(block.count) {}

  void set(Field field, std::int64_t value) { stage::encode(words_, block_.first, map_.at(field), value); }
  void set(stage::Axis axis, AxisField field, std::int64_t value) {
    stage::encode(words_, block_.first, map_.at(axis, field), value);
  }
  [[nodiscard]] std::vector<std::uint16_t> take() { return std::move(words_); }

 private:
  const stage::RegisterMap& map_;
  stage::Block block_;
  std::vector<std::uint16_t> words_;
};

// An error of the link, with what the stage was to do in front of what the link tried.
Error in_words_of(Error error, const std::string& tried) {
  error.tried = error.tried.empty() ? tried : fmt::format("{} ({})", tried, error.tried);
  return error;
}

bool is_silence(const Error& error) {
  return error.code == ErrorCode::TimedOut || error.code == ErrorCode::Unreachable;
}

bool fits(const stage::Register& reg, std::int64_t value) {
  const std::int64_t span = std::int64_t{1} << (16 * reg.words);
  return reg.is_signed ? value >= -span / 2 && value < span / 2 : value >= 0 && value < span;
}

Result<void> check_limits(const StageConfig& config, const MotionTarget& target) {
  for (const stage::Axis axis : stage::kAllAxes) {
    const auto& wanted = target[stage::index_of(axis)];
    if (!wanted) continue;
    const AxisConfig& how = config.axis(axis);
    const bool is_inside = *wanted >= how.low && *wanted <= how.high;  // false for NaN too
    if (is_inside && fits(config.registers.at(axis, AxisField::Target), counts_of(config, axis, *wanted))) continue;
    return failure({.code = ErrorCode::OutOfLimits,
                    .device = "stage",
                    .tried = motion_text(target),
                    .seen = fmt::format("{} target {:.3f} {}", stage::axis_name(axis), *wanted, stage::axis_unit(axis)),
                    .limit = is_inside
                                 ? "what its register can hold"
                                 : fmt::format("{:.3f} to {:.3f} {}", how.low, how.high, stage::axis_unit(axis))});
  }
  return {};
}

}  // namespace

ModbusStage::ModbusStage(ModbusLink& link, const StageConfig& config, const Clock& clock)
    : link_(link), config_(config), clock_(clock) {}

template <class Exchange>
Result<void> ModbusStage::talk(Exchange exchange) {
  const Instant began = clock_.now();
  Result<void> done = exchange();
  if (done || !is_silence(done.error())) {
    silent_since_.reset();
    return done;
  }
  if (!silent_since_) silent_since_ = began;
  if (!has_been_silent_too_long()) return done;
  Error error = std::move(done).error();
  error.code = ErrorCode::Unreachable;
  error.seen += fmt::format("; no answer to anything for {:.1f} s", in_seconds(clock_.now() - *silent_since_));
  error.limit = fmt::format("heartbeat timeout {:.1f} s, after which the stage stops by itself",
                            in_seconds(config_.heartbeat_timeout));
  return failure(std::move(error));
}

bool ModbusStage::has_been_silent_too_long() const {
  return silent_since_ && clock_.now() - *silent_since_ >= config_.heartbeat_timeout;
}

bool ModbusStage::is_worth_another_try(const Error& error) const {
  if (error.code == ErrorCode::BadReply) return true;
  return is_silence(error) && !has_been_silent_too_long();
}

Result<StageState> ModbusStage::read_state() {
  Result<StageState> state = look_once();
  for (int tries = 1; !state && is_worth_another_try(state.error()) && tries < kTries; ++tries) state = look_once();
  return state;
}

Result<StageState> ModbusStage::look_once() {
  const std::string tried = "read its state";
  const stage::Block block = config_.registers.status_block();
  const stage::Register& token = config_.registers.at(Field::Token);
  CommandWords written(config_.registers, {token.address, token.words});
  written.set(Field::Token, ++token_);
  std::vector<std::uint16_t> words(block.count);
  auto done = talk([&] { return link_.write_and_read(token.address, written.take(), block.first, words); });
  if (!done) {
    return failure(in_words_of(std::move(done).error(), tried));
  }
  if (const std::int64_t echoed = stage::decode(words, block.first, token); echoed != token_) {
    link_.resync();
    return failure({.code = ErrorCode::BadReply,
                    .device = "stage",
                    .tried = tried,
                    .seen = fmt::format("a reply with token {}", echoed),
                    .limit = fmt::format("token {}", token_)});
  }
  auto state = stage_state_of(words, config_);
  if (!state) return state;
  state->at = clock_.now();
  shown_ = ShownTokens{state->accepted_token, state->refused_token};
  return state;
}

// A token that the stage does not show yet, neither accepted nor refused: also not one of an earlier run of the
// program.
Result<MotionToken> ModbusStage::fresh_motion_token() {
  if (!shown_) {
    if (const Result<StageState> state = read_state(); !state) return failure(state.error());
  }
  do {
    ++motion_token_;
  } while (motion_token_ == 0 || motion_token_ == shown_->accepted || motion_token_ == shown_->refused);
  return motion_token_;
}

std::vector<std::uint16_t> ModbusStage::move_words(const MotionTarget& target, Epoch epoch, MotionToken token) const {
  CommandWords words(config_.registers, config_.registers.motion_block());
  std::int64_t mask = 0;
  for (const stage::Axis axis : stage::kAllAxes) {
    const auto& wanted = target[stage::index_of(axis)];
    if (!wanted) continue;
    mask |= std::int64_t{1} << stage::index_of(axis);
    words.set(axis, AxisField::Target, counts_of(config_, axis, *wanted));
  }
  words.set(Field::MotionEpoch, epoch);
  words.set(Field::MotionToken, token);
  words.set(Field::MotionMask, mask);
  words.set(Field::MotionCommand, config_.coordinated ? stage::kCommandMoveTogether : stage::kCommandMove);
  return words.take();
}

Result<MotionToken> ModbusStage::start_move(const MotionTarget& target, Epoch epoch) {
  GONIO_TRY(check_limits(config_, target));
  const Result<MotionToken> token = fresh_motion_token();
  if (!token) return token;
  return send_motion(move_words(target, epoch, *token), *token, motion_text(target));
}

// One exchange writes the command, then reads. Without an answer it is the command alone that is seen to.
Result<StartedMove> ModbusStage::start_move_and_look(const MotionTarget& target, Epoch epoch) {
  GONIO_TRY(check_limits(config_, target));
  const Result<MotionToken> token = fresh_motion_token();
  if (!token) return failure(token.error());
  const std::uint16_t first = config_.registers.motion_block().first;
  const stage::Block block = config_.registers.status_block();
  std::vector<std::uint16_t> command = move_words(target, epoch, *token);
  std::vector<std::uint16_t> words(block.count);
  auto sent = talk([&] { return link_.write_and_read(first, command, block.first, words); });
  if (sent) return StartedMove{*token, shown_by(words, *token)};
  if (!is_worth_another_try(sent.error())) return failure(in_words_of(std::move(sent).error(), motion_text(target)));
  const Result<MotionToken> again = send_again(std::move(command), *token, motion_text(target));
  if (!again) return failure(again.error());
  return StartedMove{*again, std::nullopt};
}

// What was read beside a command counts when it shows the command's own token: no reply to anything before can.
std::optional<StageState> ModbusStage::shown_by(std::span<const std::uint16_t> words, MotionToken token) {
  auto state = stage_state_of(words, config_);
  if (!state || (state->accepted_token != token && state->refused_token != token)) return std::nullopt;
  state->at = clock_.now();
  shown_ = ShownTokens{state->accepted_token, state->refused_token};
  return std::optional(std::move(*state));
}

Result<MotionToken> ModbusStage::start_homing(Epoch epoch) {
  const Result<MotionToken> token = fresh_motion_token();
  if (!token) return token;
  CommandWords words(config_.registers, config_.registers.motion_block());
  words.set(Field::MotionEpoch, epoch);
  words.set(Field::MotionToken, *token);
  words.set(Field::MotionMask, (1 << stage::kAxisCount) - 1);
  words.set(Field::MotionCommand, stage::kCommandHome);
  return send_motion(words.take(), *token, "home all axes");
}

Result<MotionToken> ModbusStage::send_motion(std::vector<std::uint16_t> words, MotionToken token,
                                             const std::string& tried) {
  const std::uint16_t first = config_.registers.motion_block().first;
  auto sent = talk([&] { return link_.write_registers(first, words); });
  if (sent) return token;
  if (!is_worth_another_try(sent.error())) return failure(in_words_of(std::move(sent).error(), tried));
  return send_again(std::move(words), token, tried);
}

Result<MotionToken> ModbusStage::send_again(std::vector<std::uint16_t> words, MotionToken token,
                                            const std::string& tried) {
  const std::uint16_t first = config_.registers.motion_block().first;
  // The reply is missing, not necessarily the command: the stage knows.
  const Result<StageState> state = read_state();
  if (!state) return failure(in_words_of(state.error(), tried));
  if (state->accepted_token == token || state->refused_token == token) return token;
  auto sent = talk([&] { return link_.write_registers(first, words); });
  if (!sent) return failure(in_words_of(std::move(sent).error(), tried));
  return token;
}

// For commands that may arrive twice: they set a state, they do not start anything.
Result<void> ModbusStage::write_again(std::uint16_t first, const std::vector<std::uint16_t>& words,
                                      const std::string& tried) {
  const auto write = [&] { return link_.write_registers(first, words); };
  Result<void> sent = talk(write);
  for (int tries = 1; !sent && is_worth_another_try(sent.error()) && tries < kTries; ++tries) {
    sent = talk(write);
  }
  if (!sent) return failure(in_words_of(std::move(sent).error(), tried));
  return {};
}

Result<void> ModbusStage::set_shutters(bool source_open, bool detector_open) {
  const stage::Block block = config_.registers.shutter_block();
  CommandWords words(config_.registers, block);
  words.set(Field::SourceShutterCommand, source_open ? 1 : 0);
  words.set(Field::DetectorShutterCommand, detector_open ? 1 : 0);
  return write_again(block.first, words.take(),
                     fmt::format("{} the source shutter, {} the detector shutter", source_open ? "open" : "close",
                                 detector_open ? "open" : "close"));
}

Result<void> ModbusStage::reset(Epoch epoch) {
  const stage::Block block = config_.registers.reset_block();
  CommandWords words(config_.registers, block);
  words.set(Field::ResetEpoch, epoch);
  words.set(Field::ResetKey, stage::kResetKey);
  return write_again(block.first, words.take(), fmt::format("reset with epoch {}", epoch));
}

}  // namespace gonio::drivers
