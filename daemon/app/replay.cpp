#include "daemon/app/replay.h"

#include <fmt/format.h>

#include <ostream>

#include "daemon/app/devices.h"
#include "daemon/app/engine.h"
#include "daemon/app/recording.h"
#include "daemon/store/store_comparison.h"
#include "daemon/store/store_writer.h"
#include "daemon/tape/tape_deck.h"
#include "daemon/tape/tape_input.h"
#include "daemon/tape/taped_halt_line.h"
#include "drivers/links/tape/tape_player.h"

namespace gonio::daemon {
namespace {

/// What was done, for the summary.
struct Tally {
  std::int64_t turns = 0;
  std::int64_t inputs = 0;
  std::int64_t accepted = 0;
};

Result<Instrument> instrument_of(const ReplayWanted& wanted, const drivers::TapeStart& start) {
  if (!wanted.instrument_file.empty()) return read_instrument(wanted.instrument_file);
  return parse_instrument(start.instrument_text, "instrument.toml of the tape");
}

// Rows are numbered on from what was there: on another store the same night gives other numbers.
Result<void> check_store(const std::string& file, const drivers::TapeStart& start) {
  const std::int64_t held = last_event_of(file);
  if (held == start.last_event) return {};
  return failure(
      {.code = ErrorCode::WrongState,
       .device = "store",
       .tried = "replay into " + file,
       .seen = fmt::format("it holds {} events", held),
       .limit = fmt::format("the recording began on a store of {}: replay what came before it first, or give "
                            "a copy of the store as it was",
                            start.last_event)});
}

Result<void> act(const drivers::TapeTurn& turn, Engine& engine, Devices& devices) {
  if (turn.party == drivers::TapeParty::Halt) {
    take_turn(devices.halt_line(), turn);
    return {};
  }
  return engine.take_turn(turn);
}

// One thing after the other, as the tape has them, until it ends or something is not as it was.
Result<void> play(drivers::TapePlayer& player, Engine& engine, Devices& devices, const Instrument& instrument,
                  Tally& tally) {
  while (true) {
    Result<std::optional<drivers::TapePlayer::Step>> step = player.next();
    if (!step) return failure(std::move(step).error());
    if (!*step) return {};
    if (const auto* input = std::get_if<drivers::TapeInput>(&(*step)->what)) {
      Result<SequencerMessage> message = message_of(*input, instrument);
      if (!message) return failure(std::move(message).error());
      engine.take_in(std::move(*message));
      ++tally.inputs;
      continue;
    }
    ++tally.turns;
    Result<void> done = act(std::get<drivers::TapeTurn>((*step)->what), engine, devices);
    if (done) continue;
    done.error().tried = fmt::format("replay record {}: {}", (*step)->number, done.error().tried);
    return done;
  }
}

void tell(const drivers::TapePlayer& player, const Tally& tally, Duration took, std::ostream& out) {
  const double life_s = in_seconds(player.latest() - player.reader().start().boottime);
  const double took_s = in_seconds(took);
  out << fmt::format("replayed {} exchanges, {} turns, {} commands and STOPs; {} items accepted\n", player.exchanges(),
                     tally.turns, tally.inputs, tally.accepted);
  out << fmt::format("life {:.3f} s, replay {:.3f} s: {:.1f} times faster\n", life_s, took_s,
                     took_s > 0.0 ? life_s / took_s : 0.0);
  out << fmt::format("the tape: {}\n", player.reader().tail());
}

Result<void> compare(const ReplayWanted& wanted, std::ostream& out) {
  if (wanted.against.empty()) return {};
  const Result<StoreComparison> found = compare_stores(wanted.store_file, wanted.against);
  if (!found) return failure(found.error());
  out << fmt::format("the store is that of {}: {} rows, {} measured times differ\n", wanted.against, found->rows,
                     found->times_that_differ);
  return {};
}

}  // namespace

Result<void> replay(const ReplayWanted& wanted, std::ostream& out) {
  const SystemClock clock;
  const Instant began = clock.now();
  Result<drivers::TapeReader> reader = drivers::TapeReader::open(wanted.tape_file);
  if (!reader) return failure(std::move(reader).error());
  const drivers::TapeStart& start = reader->start();
  const Result<Instrument> instrument = instrument_of(wanted, start);
  if (!instrument) return failure(instrument.error());
  GONIO_TRY(check_store(wanted.store_file, start));

  drivers::TapePlayer player(*reader);
  TapeDeck deck(clock, player);
  Devices devices(*instrument, deck);
  const Result<std::unique_ptr<StoreWriter>> writer =
      StoreWriter::open({.path = wanted.store_file, .boot_id = start.boot_id, .version = GONIO_VERSION},
                        deck.clock(drivers::TapeParty::Store));
  if (!writer) return failure(writer.error());
  Tally tally;
  {
    Engine engine(
        {.instrument = *instrument, .store_file = wanted.store_file, .tape = nullptr, .by_hand_from = start.boottime},
        devices.all(), **writer, clock,
        [&tally](const EventRecord& event) { tally.accepted += event.kind == "item-accepted" ? 1 : 0; });
    GONIO_TRY(play(player, engine, devices, *instrument, tally));
  }
  tell(player, tally, clock.now() - began, out);
  return compare(wanted, out);
}

}  // namespace gonio::daemon
