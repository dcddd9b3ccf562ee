// The tape as a file: what was put comes back, and what is torn or damaged is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>

#include "drivers/links/tape/tape_writer.h"
#include "tests/drivers/tape/memory_tape.h"

namespace gonio::drivers {
namespace {

using test::MemoryTape;

Instant at(std::int64_t ns) {
  return Instant(Duration(ns));
}

std::vector<TapeRecord> one_of_each() {
  return {TapeTurn{.party = TapeParty::Sequencer, .source = 3, .now = at(-5), .argument = -7},
          TapeExchange{.party = TapeParty::Halt,
                       .link = 1,
                       .call = TapeCall::WriteRegisters,
                       .asked = at(10),
                       .answered = at(20),
                       .request = {1, 2, 3},
                       .error = Error{.code = ErrorCode::TimedOut,
                                      .device = "stage",
                                      .tried = "beat",
                                      .seen = "silence",
                                      .limit = "250 ms"},
                       .reply = {},
                       .pixels = {}},
          TapeExchange{.party = TapeParty::Detector,
                       .call = TapeCall::CameraPop,
                       .request = {},
                       .error = {},
                       .reply = {9, 8},
                       .pixels = {0, 65535, 1, 32768, 32767, 4095}},
          TapeInput{.kind = "command", .text = "{\"scan\": 3}"},
          TapeReading{.party = TapeParty::Store, .is_utc = true, .ns = 1'700'000'000'000'000'000}};
}

std::vector<TapeRecord> all_of(TapeReader& reader) {
  std::vector<TapeRecord> records;
  while (true) {
    Result<std::optional<TapeRecord>> next = reader.next();
    EXPECT_TRUE(next) << describe(next.error());
    if (!next || !*next) return records;
    records.push_back(std::move(**next));
  }
}

class TapeFile : public testing::Test {
 protected:
  TapeFile() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = testing::TempDir() + "tape-" + info->name() + "-" + std::to_string(getpid());
    std::filesystem::remove(path_);
  }
  ~TapeFile() override { std::filesystem::remove(path_); }

  std::unique_ptr<TapeWriter> writer(std::size_t most_waiting = std::size_t{1} << 20U) {
    auto made = TapeWriter::create({.file = path_, .most_waiting = most_waiting}, {.program_version = "0.1.0"},
                                   [this](const Error& error) {
                                     const std::lock_guard lock(mutex_);
                                     ended_ = error;
                                   });
    EXPECT_TRUE(made) << describe(made.error());
    return std::move(*made);
  }

  std::string path_;
  std::mutex mutex_;
  std::optional<Error> ended_;
};

TEST_F(TapeFile, GivesBackEveryRecordThatWasPut) {
  {
    const auto tape = writer();
    for (const TapeRecord& record : one_of_each()) tape->put(record);
  }

  Result<TapeReader> reader = TapeReader::open(path_);

  ASSERT_TRUE(reader) << describe(reader.error());
  EXPECT_EQ(reader->start().program_version, "0.1.0");
  EXPECT_EQ(all_of(*reader), one_of_each());
  EXPECT_EQ(reader->tail(), "ended");
}

TEST_F(TapeFile, IsNeverWrittenOverAnother) {
  writer();

  const auto second = TapeWriter::create({.file = path_}, {}, [](const Error&) {});

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::InvalidInput);
}

TEST_F(TapeFile, EndsWithAWordWhenTheDiskTakesNoMore) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{.rlim_cur = 300, .rlim_max = before.rlim_max};
  {
    const auto tape = writer();
    setrlimit(RLIMIT_FSIZE, &small);
    for (int i = 0; i < 20; ++i) tape->put(TapeInput{.kind = "note", .text = "twenty letters of it"});
  }
  setrlimit(RLIMIT_FSIZE, &before);

  ASSERT_TRUE(ended_.has_value());
  EXPECT_EQ(ended_->code, ErrorCode::StoreFailed) << describe(*ended_);
  Result<TapeReader> reader = TapeReader::open(path_);
  ASSERT_TRUE(reader) << "what was written before stays a tape";
  EXPECT_FALSE(all_of(*reader).empty());
  EXPECT_THAT(reader->tail(), testing::HasSubstr("cut off"));
}

TEST_F(TapeFile, EndsWithAWordWhenMoreWaitsThanMay) {
  {
    const auto tape = writer(1000);
    TapeExchange frame{.party = TapeParty::Detector, .call = TapeCall::CameraPop, .request = {}, .error = {}};
    frame.pixels.assign(1000, 7);
    tape->put(frame);
    tape->put(TapeInput{.kind = "later", .text = {}});
  }

  ASSERT_TRUE(ended_.has_value());
  EXPECT_EQ(ended_->code, ErrorCode::TooLarge);
  Result<TapeReader> reader = TapeReader::open(path_);
  ASSERT_TRUE(reader) << "what was written before stays a tape";
  EXPECT_TRUE(all_of(*reader).empty());
}

TEST(TapeReading, EndsAtARecordThatIsTornWhereverItIsTorn) {
  MemoryTape tape;
  tape.records = one_of_each();
  const std::string whole = tape.file();
  MemoryTape shorter;
  shorter.records.assign(tape.records.begin(), tape.records.end() - 1);
  const std::size_t before_the_last = shorter.file().size();

  for (std::size_t cut = before_the_last; cut < whole.size(); ++cut) {
    SCOPED_TRACE("cut at byte " + std::to_string(cut));
    Result<TapeReader> reader = MemoryTape::read(whole.substr(0, cut));
    ASSERT_TRUE(reader);
    EXPECT_EQ(all_of(*reader), shorter.records);
    EXPECT_THAT(reader->tail(), testing::HasSubstr("cut off"));
  }
}

TEST(TapeReading, RefusesWhatIsNoTape) {
  for (const std::string& bytes : {std::string(), std::string("SQLite format 3"), std::string(400, '\0')}) {
    const Result<TapeReader> reader = MemoryTape::read(bytes);
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().code, ErrorCode::InvalidInput) << describe(reader.error());
  }
}

TEST(TapeReading, RefusesAnotherVersionAndNamesIt) {
  std::string bytes = MemoryTape().file();
  bytes[kTapeMagic.size() - 1] = 9;

  const Result<TapeReader> reader = MemoryTape::read(bytes);

  ASSERT_FALSE(reader);
  EXPECT_THAT(describe(reader.error()), testing::HasSubstr("layout version 9"));
}

TEST(TapeReading, NamesRecordAndPlaceOfDamageInTheMidst) {
  MemoryTape tape;
  tape.records = one_of_each();
  std::string bytes = tape.file();
  const std::size_t start = MemoryTape().file().size();
  bytes[start + kTapeRecordHead + 2] ^= 0x10;  // in the first record after the start

  Result<TapeReader> reader = MemoryTape::read(bytes);
  ASSERT_TRUE(reader);
  const auto next = reader->next();

  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::IncompleteData);
  EXPECT_THAT(describe(next.error()), testing::HasSubstr("record 1, " + std::to_string(start) + " bytes"));
}

TEST(TapeReading, SurvivesAnyByteChanged) {
  MemoryTape tape;
  tape.records = one_of_each();
  const std::string whole = tape.file();
  for (std::size_t place = 0; place < whole.size(); ++place) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string bytes = whole;
      bytes[place] = static_cast<char>(bytes[place] ^ flip);
      Result<TapeReader> reader = MemoryTape::read(bytes);
      for (int i = 0; reader && i < 10; ++i) {
        const auto next = reader->next();
        if (!next || !*next) break;
      }
    }
  }
}

TEST(TapeFormat, DecodesNoPayloadThatIsShortOrLong) {
  for (const TapeRecord& record : one_of_each()) {
    std::vector<std::uint8_t> payload = encode_record(record);
    for (std::size_t size = 0; size < payload.size(); ++size) {
      EXPECT_FALSE(decode_record(std::span(payload).first(size))) << size << " of " << payload.size();
    }
    payload.push_back(0);
    EXPECT_FALSE(decode_record(payload));
  }
}

TEST(TapeFormat, KeepsItsLayout) {
  // By the table in drivers/links/tape/README.md.
  const std::vector<std::uint8_t> turn{2,    5,    3,    0xFB, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,
                                       0xFF, 0x02, 0x01, 0,    0,    0,    0,    0,    0};
  EXPECT_EQ(encode_record(TapeTurn{.party = TapeParty::Sequencer, .source = 3, .now = at(-5), .argument = 258}), turn);
  const std::vector<std::uint8_t> input{4, 1, 0, 0, 0, 'a', 2, 0, 0, 0, 'b', 'c'};
  EXPECT_EQ(encode_record(TapeInput{.kind = "a", .text = "bc"}), input);
}

TEST(PixelPacking, LosesNothing) {
  constexpr unsigned kSeed = 20261122;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 chance(kSeed);
  for (const std::size_t count : {1U, 2U, 255U, 4096U}) {
    std::vector<std::uint16_t> pixels(count);
    for (std::uint16_t& pixel : pixels) pixel = static_cast<std::uint16_t>(chance());

    const auto back = unpack_pixels(pack_pixels(pixels), count);

    ASSERT_TRUE(back) << describe(back.error());
    EXPECT_EQ(*back, pixels);
  }
}

TEST(PixelPacking, MakesAFrameOfAFewCountsOfNoiseLessThanHalfAsLarge) {
  std::mt19937 chance(1);
  std::vector<std::uint16_t> pixels(std::size_t{1} << 16U);
  for (std::uint16_t& pixel : pixels) pixel = static_cast<std::uint16_t>(1000 + chance() % 8);

  EXPECT_LT(pack_pixels(pixels).size(), pixels.size());  // bytes against words
}

TEST(PixelPacking, RefusesAnotherNumberOfPixels) {
  const std::vector<std::uint8_t> packed = pack_pixels(std::vector<std::uint16_t>(10, 3));

  EXPECT_FALSE(unpack_pixels(packed, 9));
  EXPECT_FALSE(unpack_pixels(packed, 11));
}

}  // namespace
}  // namespace gonio::drivers
