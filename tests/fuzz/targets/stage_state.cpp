// The stage's driver over a link that serves the input: words of the status block, lost replies, exceptions.
#include <array>
#include <cmath>
#include <vector>

#include "drivers/modbus_stage/modbus_halt_line.h"
#include "drivers/modbus_stage/modbus_stage.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

using drivers::StageState;
using stage::Field;

constexpr std::size_t kRegisters = 512;
constexpr int kMostExchanges = 32;  // of one call: three tries, each with a look behind it

// A unit that echoes the token and says who it is, but for what the input overlays.
class FuzzedUnit final : public drivers::ModbusLink {
 public:
  FuzzedUnit(ByteSource& source, const stage::RegisterMap& map, ManualClock& clock)
      : source_(source), map_(map), clock_(clock) {
    put(Field::Identity, stage::kIdentity);
    put(Field::MapVersion, stage::kMapVersion);
  }

  Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override {
    GONIO_TRY(outcome());
    return serve(first, into);
  }
  Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override {
    Result<void> done = outcome();
    const bool arrives = done || (source_.byte() & 1U) != 0;
    if (arrives) take(first, words);
    return done;
  }
  Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words, std::uint16_t read_first,
                              std::span<std::uint16_t> into) override {
    GONIO_TRY(outcome());
    take(write_first, words);
    return serve(read_first, into);
  }
  void resync() override {}
  void interrupt() override {}

  /// Since the last call.
  int count_exchanges() { return std::exchange(exchanges_, 0); }
  /// What the last read gave.
  [[nodiscard]] std::span<const std::uint16_t> served() const { return served_; }
  [[nodiscard]] std::uint16_t written_token() const { return registers_[map_.at(Field::Token).address]; }

 private:
  void put(Field field, std::int64_t value) { stage::encode(registers_, 0, map_.at(field), value); }
  void take(std::uint16_t first, std::span<const std::uint16_t> words) {
    hold(first + words.size() <= registers_.size(), "a command lies in the map");
    std::copy(words.begin(), words.end(), registers_.begin() + first);
  }
  // Overlays a few words at places that the input names.
  Result<void> serve(std::uint16_t first, std::span<std::uint16_t> into) {
    hold(first + into.size() <= registers_.size(), "what is read lies in the map");
    std::copy_n(registers_.begin() + first, into.size(), into.begin());
    const std::size_t changes = source_.byte() % 16;
    for (std::size_t k = 0; k < changes; ++k) into[source_.byte() % into.size()] = source_.word();
    served_.assign(into.begin(), into.end());
    return {};
  }
  Result<void> outcome() {
    ++exchanges_;
    hold(exchanges_ <= kMostExchanges, "the tries of a call are bounded");
    constexpr std::array kErrors{ErrorCode::TimedOut, ErrorCode::Unreachable, ErrorCode::BadReply,
                                 ErrorCode::DeviceRefused};
    const std::uint8_t what = source_.byte();
    clock_.advance(std::chrono::milliseconds(what));
    if (what < 0xC0) return {};
    return failure(
        {.code = kErrors[what % kErrors.size()], .device = "stage", .tried = "talk", .seen = "trouble", .limit = {}});
  }

  ByteSource& source_;
  const stage::RegisterMap& map_;
  ManualClock& clock_;
  std::array<std::uint16_t, kRegisters> registers_{};
  std::vector<std::uint16_t> served_;
  int exchanges_ = 0;
};

drivers::StageConfig bench_config() {
  drivers::StageConfig config;
  config.registers = stage::own_register_map();
  for (const stage::Axis axis : stage::kAllAxes)
    config.axes[stage::index_of(axis)] = {.offset = 0.25, .low = -10.0, .high = 85.0};
  config.heartbeat_timeout = std::chrono::seconds(2);
  return config;
}

void hold_state(const StageState& state, const FuzzedUnit& unit, const drivers::StageConfig& config) {
  const stage::Block block = config.registers.status_block();
  const auto word = [&](Field field) { return stage::decode(unit.served(), block.first, config.registers.at(field)); };
  hold(word(Field::Identity) == stage::kIdentity, "a state is of our kind of stage");
  hold(word(Field::MapVersion) == stage::kMapVersion, "a state is of our map");
  hold(word(Field::Token) == unit.written_token(), "a state answers the request in hand");
  hold(state.boot_counter == word(Field::BootCounter), "a state says what was read");
  for (const stage::Axis axis : stage::kAllAxes) {
    const drivers::AxisState& one = state.axes[stage::index_of(axis)];
    const double scale = config.registers.axis_scale[stage::index_of(axis)];
    const double expected = 0.25 + scale * static_cast<double>(one.counts);
    hold(std::abs(one.position - expected) <= 1e-9 * (1.0 + std::abs(expected)), "a position is its counts");
  }
  hold(std::isfinite(state.monitor) && std::isfinite(state.humidity_percent) && std::isfinite(state.lamp_temperature_c),
       "sensors are finite");
}

// One call, whichever the input asks for.
Result<void> call(drivers::ModbusStage& stage, drivers::ModbusHaltLine& halts, ByteSource& source) {
  const auto without_value = [](auto result) -> Result<void> {
    if (!result) return failure(std::move(result).error());
    return {};
  };
  const drivers::Epoch epoch = source.word();
  switch (source.byte() % 6) {
    case 0: {
      drivers::MotionTarget target{};
      for (auto& wanted : target) {
        if ((source.byte() & 1U) != 0) wanted = static_cast<double>(source.word()) / 256.0 - 20.0;
      }
      return without_value(stage.start_move(target, epoch));
    }
    case 1:
      return without_value(stage.start_homing(epoch));
    case 2:
      return stage.set_shutters((source.byte() & 1U) != 0, (source.byte() & 1U) != 0);
    case 3:
      return stage.reset(epoch);
    case 4:
      return halts.halt(epoch);
    default:
      return halts.beat();
  }
}

}  // namespace

void stage_state(Bytes input) {
  static const drivers::StageConfig config = bench_config();
  ByteSource source(input);
  ManualClock clock;
  FuzzedUnit unit(source, config.registers, clock);
  drivers::ModbusStage stage(unit, config, clock);
  drivers::ModbusHaltLine halts(unit, config.registers);
  for (int step = 0; step < 20 && !source.is_empty(); ++step) {
    unit.count_exchanges();
    if ((source.byte() & 1U) != 0) {
      if (const Result<void> done = call(stage, halts, source); !done) hold_device_error(done.error());
      continue;
    }
    const Result<StageState> state = stage.read_state();
    if (state)
      hold_state(*state, unit, config);
    else
      hold_device_error(state.error());
  }
}

}  // namespace gonio::fuzz
