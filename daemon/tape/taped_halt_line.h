#pragma once

#include "base/clock.h"
#include "drivers/links/tape/tape_record.h"
#include "drivers/links/tape/tape_sink.h"
#include "drivers/stage.h"

namespace gonio::daemon {

/// What a turn of the halt thread was: these are its sources.
enum class HaltTurn : std::uint8_t { Halt = 1, Watch = 2, Beat = 3 };

/// A halt line whose calls are recorded as turns of their own. When a beat is due, or a STOP comes, wall time and
/// people decide: a replay takes both from the tape. All outlive it. Threads: the halt thread, but for `interrupt`.
class TapedHaltLine final : public drivers::HaltLine {
 public:
  TapedHaltLine(drivers::HaltLine& line, drivers::TapeSink& sink, const Clock& clock)
      : line_(line), sink_(sink), clock_(clock) {}

  Result<void> halt(drivers::Epoch epoch) override {
    note(HaltTurn::Halt, static_cast<std::int64_t>(epoch));
    return line_.halt(epoch);
  }
  Result<void> watch_heartbeat(Duration timeout) override {
    note(HaltTurn::Watch, timeout.count());
    return line_.watch_heartbeat(timeout);
  }
  Result<void> beat() override {
    note(HaltTurn::Beat, 0);
    return line_.beat();
  }
  void interrupt() override { line_.interrupt(); }

 private:
  void note(HaltTurn what, std::int64_t argument) {
    sink_.put(drivers::TapeTurn{.party = drivers::TapeParty::Halt,
                                .source = static_cast<std::uint8_t>(what),
                                .now = clock_.now(),
                                .argument = argument});
  }

  drivers::HaltLine& line_;
  drivers::TapeSink& sink_;
  const Clock& clock_;
};

/// Makes a halt line do one recorded turn again; what came of it is on the tape, and the sequencer is told by it.
void take_turn(drivers::HaltLine& line, const drivers::TapeTurn& turn);

/// A line to nothing: a replay's halt path has nobody to stop.
class IdleHaltLine final : public drivers::HaltLine {
 public:
  Result<void> halt(drivers::Epoch /*epoch*/) override { return {}; }
  Result<void> watch_heartbeat(Duration /*timeout*/) override { return {}; }
  Result<void> beat() override { return {}; }
  void interrupt() override {}
};

}  // namespace gonio::daemon
