// What the tape's player says when the program does something else than then.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/links/tape/exchange_bytes.h"
#include "drivers/links/tape/replay_links.h"
#include "tests/drivers/tape/memory_tape.h"

namespace gonio::drivers {
namespace {

using test::MemoryTape;
using testing::HasSubstr;

Instant at(std::int64_t ns) {
  return Instant(Duration(ns));
}

class Replay : public testing::Test {
 protected:
  void turn(TapeParty party, std::int64_t now) { tape_.put(TapeTurn{.party = party, .now = at(now)}); }
  void reading(TapeParty party, std::int64_t ns) { tape_.put(TapeReading{.party = party, .ns = ns}); }
  // The stage reads `count` registers from 10, and gets zeros.
  void read(std::uint16_t count, std::int64_t asked) {
    tape_.put(TapeExchange{.party = TapeParty::Stage,
                           .call = TapeCall::ReadRegisters,
                           .asked = at(asked),
                           .answered = at(asked + 5),
                           .request = request_to_read(10, count),
                           .error = {},
                           .reply = std::vector<std::uint8_t>(2U * count),
                           .pixels = {}});
  }
  TapePlayer& play() {
    auto reader = MemoryTape::read(tape_.file());
    EXPECT_TRUE(reader) << describe(reader.error());
    reader_.emplace(std::move(*reader));
    player_.emplace(*reader_);
    return *player_;
  }
  static Result<void> ask(ModbusLink& link, std::size_t count) {
    std::vector<std::uint16_t> words(count);
    return link.read_registers(10, words);
  }
  // The next turn or input, which must be there.
  static TapePlayer::Step step(TapePlayer& player) {
    auto next = player.next();
    EXPECT_TRUE(next && *next);
    return next && *next ? std::move(**next) : TapePlayer::Step{};
  }

  MemoryTape tape_;
  std::optional<TapeReader> reader_;
  std::optional<TapePlayer> player_;
};

TEST_F(Replay, StopsAtAnotherRequestAndSaysWhatWasAskedNowAndThen) {
  turn(TapeParty::Stage, 2'000'000'000);
  read(3, 2'500'001'000);
  TapePlayer& player = play();
  ReplayModbusLink link(player, TapeParty::Stage);
  (void)step(player);

  const Result<void> asked = ask(link, 4);

  ASSERT_FALSE(asked);
  EXPECT_EQ(asked.error().code, ErrorCode::ReplayDiffers);
  const std::string words = describe(asked.error());
  EXPECT_THAT(words, HasSubstr("stage: replay record 2, 2.500000 s after the start"));
  EXPECT_THAT(words, HasSubstr("asked now: read 4 registers from 10"));
  EXPECT_THAT(words, HasSubstr("then: read 3 registers from 10"));
  EXPECT_FALSE(ask(link, 3)) << "after a difference nothing is answered any more";
  EXPECT_FALSE(player.next());
}

TEST_F(Replay, StopsWhenATurnLeavesSomethingUnasked) {
  turn(TapeParty::Stage, 2000);
  read(3, 2001);
  turn(TapeParty::Stage, 3000);
  TapePlayer& player = play();
  (void)step(player);

  const auto next = player.next();

  ASSERT_FALSE(next);
  EXPECT_THAT(describe(next.error()), HasSubstr("asked now: nothing: then: read 3 registers from 10"));
}

TEST_F(Replay, StopsWhenATurnAsksForMore) {
  turn(TapeParty::Stage, 2000);
  turn(TapeParty::Stage, 3000);
  read(3, 3001);
  TapePlayer& player = play();
  ReplayModbusLink link(player, TapeParty::Stage);
  (void)step(player);

  EXPECT_THAT(describe(ask(link, 3).error()), HasSubstr("then: nothing more in this turn"));
}

TEST_F(Replay, StopsWhereTheTapeEnds) {
  turn(TapeParty::Stage, 2000);
  TapePlayer& player = play();
  ReplayModbusLink link(player, TapeParty::Stage);
  (void)step(player);

  EXPECT_THAT(describe(ask(link, 3).error()), HasSubstr("the tape has ended: cut off between two records"));
}

TEST_F(Replay, KeepsThePartiesApartWhateverTheirOrderOnTheTape) {
  turn(TapeParty::Stage, 2000);
  turn(TapeParty::Store, 2001);
  reading(TapeParty::Store, 2002);
  read(3, 2003);
  tape_.put(TapeInput{.kind = "command", .text = "{}"});
  TapePlayer& player = play();
  ReplayModbusLink link(player, TapeParty::Stage);

  EXPECT_EQ(std::get<TapeTurn>(step(player).what).party, TapeParty::Stage);
  EXPECT_TRUE(ask(link, 3));
  EXPECT_EQ(std::get<TapeTurn>(step(player).what).party, TapeParty::Store);
  EXPECT_EQ(player.now(TapeParty::Store), at(2002));
  EXPECT_EQ(std::get<TapeInput>(step(player).what).kind, "command");
  const auto end = player.next();
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->has_value());
}

TEST_F(Replay, GivesEachClockReadingAsItWasAndMakesUpForOnesThatWereNot) {
  turn(TapeParty::Stage, 2000);
  reading(TapeParty::Stage, 2100);
  read(3, 2200);
  reading(TapeParty::Stage, 2300);
  reading(TapeParty::Stage, 2400);
  turn(TapeParty::Stage, 3000);
  TapePlayer& player = play();
  ReplayModbusLink link(player, TapeParty::Stage);
  const ReplayClock clock(player, TapeParty::Stage);
  (void)step(player);

  EXPECT_EQ(clock.now(), at(2100));
  EXPECT_EQ(clock.now(), at(2100)) << "one reading more than then: time stands";
  EXPECT_TRUE(ask(link, 3));
  EXPECT_EQ(clock.now(), at(2300));
  (void)step(player);
  EXPECT_EQ(clock.now(), at(3000)) << "one reading less than then: passed over";
}

TEST_F(Replay, TakesADamagedTapeForNoDifferenceOfTheProgram) {
  turn(TapeParty::Stage, 2000);
  read(3, 2001);
  turn(TapeParty::Stage, 2002);
  std::string bytes = tape_.file();
  MemoryTape first;
  first.put(tape_.records[0]);
  bytes[first.file().size() + kTapeRecordHead + 5] ^= 1;
  auto reader = MemoryTape::read(bytes);
  ASSERT_TRUE(reader);
  TapePlayer player(*reader);
  ReplayModbusLink link(player, TapeParty::Stage);
  (void)step(player);

  EXPECT_EQ(ask(link, 3).error().code, ErrorCode::IncompleteData);
}

}  // namespace
}  // namespace gonio::drivers
