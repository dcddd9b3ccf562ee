#include "protocol/usbtmc/scpi.h"

#include <gtest/gtest.h>

namespace gonio::scpi {
namespace {

using Parts = std::vector<std::string>;

TEST(Scpi, SplitsCommandsAtSemicolonsOutsideOfQuotes) {
  EXPECT_EQ(*split("*CLS;SENS:CORR:WAV 568 ; :DISP:TEXT \"a;b\"\n", ';'),
            (Parts{"*CLS", "SENS:CORR:WAV 568", ":DISP:TEXT \"a;b\""}));
}

TEST(Scpi, KnowsQuotesInsideOfQuotes) {
  EXPECT_EQ(*split("'it''s; one',\"two \"\",\"\" still\",3", ','),
            (Parts{"'it''s; one'", "\"two \"\",\"\" still\"", "3"}));
}

TEST(Scpi, HasNoPartsInAnEmptyText) {
  EXPECT_TRUE(split(" \n", ';')->empty());
}

TEST(Scpi, RefusesOpenQuotesAndEmptyParts) {
  for (const char* text : {"A \"b;c", "'", "A;;B", ";A", "A;", "A \"b\"\";"}) {
    SCOPED_TRACE(text);
    EXPECT_EQ(split(text, ';').error().code, ErrorCode::BadReply);
  }
}

struct NumberCase {
  const char* text;
  double value;
};

TEST(Scpi, ReadsDecimalNumbers) {
  for (const NumberCase& c :
       {NumberCase{"0", 0.0}, NumberCase{"-17", -17.0}, NumberCase{"+42", 42.0}, NumberCase{"1.25", 1.25},
        NumberCase{".5", 0.5}, NumberCase{"5.", 5.0}, NumberCase{"1.500000E-03", 1.5e-3}, NumberCase{"-2e+2", -200.0},
        NumberCase{" 1.0E-6\r\n", 1e-6}, NumberCase{"9.8E37", 9.8e37}}) {
    SCOPED_TRACE(c.text);
    const auto number = parse_number(c.text);

    ASSERT_TRUE(number) << describe(number.error());
    EXPECT_EQ(number->kind, NumberKind::Finite);
    EXPECT_EQ(number->value, c.value);
  }
}

TEST(Scpi, RefusesWhatIsNoDecimalNumber) {
  for (const char* text : {"", " ", "+", ".", "E5", "1E", "1E+", "1.2.3", "1,5", "1 2", "12 mW", "inf", "nan", "0x10",
                           "1e5x", "++1", "1.0E5.0", "1e999", "\x01"}) {
    SCOPED_TRACE(text);
    EXPECT_EQ(parse_number(text).error().code, ErrorCode::BadReply);
    EXPECT_FALSE(parse_reading(text));
  }
}

TEST(Scpi, KnowsTheNumbersThatAreNone) {
  EXPECT_EQ(parse_number("9.91E37")->kind, NumberKind::NotANumber);
  EXPECT_EQ(parse_number("9.910000E+37")->kind, NumberKind::NotANumber);
  EXPECT_EQ(parse_number("9.9E37")->kind, NumberKind::Infinity);
  EXPECT_EQ(parse_number("+9.900000E+37")->kind, NumberKind::Infinity);
  EXPECT_EQ(parse_number("-9.9E37")->kind, NumberKind::NegativeInfinity);
  EXPECT_EQ(parse_number("1E38")->kind, NumberKind::Infinity);
}

TEST(Scpi, MakesErrorsOfReadingsThatAreNone) {
  EXPECT_EQ(*parse_reading("1.5E-3\n"), 1.5e-3);
  EXPECT_EQ(parse_reading("9.91E37").error().code, ErrorCode::BadReply);
  EXPECT_EQ(parse_reading("9.9E37").error().code, ErrorCode::Saturated);
  EXPECT_EQ(parse_reading("-9.9E37").error().code, ErrorCode::Saturated);
}

TEST(Scpi, ReadsWholeNumbersOnly) {
  EXPECT_EQ(*parse_integer("+12\n"), 12);
  EXPECT_EQ(*parse_integer("-350"), -350);
  for (const char* text : {"", "1.5", "1E3", "99999999999999999999", "x"}) {
    SCOPED_TRACE(text);
    EXPECT_EQ(parse_integer(text).error().code, ErrorCode::BadReply);
  }
}

TEST(Scpi, ReadsFlags) {
  EXPECT_TRUE(*parse_flag("1\n"));
  EXPECT_TRUE(*parse_flag("ON"));
  EXPECT_FALSE(*parse_flag("0"));
  EXPECT_FALSE(*parse_flag("OFF"));
  EXPECT_EQ(parse_flag("2").error().code, ErrorCode::BadReply);
}

TEST(Scpi, ReadsAndWritesQuotedText) {
  EXPECT_EQ(*parse_quoted("\"say \"\"no\"\"\""), "say \"no\"");
  EXPECT_EQ(*parse_quoted("'it''s'"), "it's");
  EXPECT_EQ(quoted("say \"no\""), "\"say \"\"no\"\"\"");
  for (const char* text : {"", "\"", "plain", "\"a'", "\"a\"b\""}) {
    SCOPED_TRACE(text);
    EXPECT_EQ(parse_quoted(text).error().code, ErrorCode::BadReply);
  }
}

TEST(Scpi, ReadsEntriesOfTheErrorQueue) {
  EXPECT_EQ(*parse_error_entry("-113,\"Undefined header\"\n"), (ErrorEntry{-113, "Undefined header"}));
  EXPECT_EQ(*parse_error_entry("+0,\"No error\""), (ErrorEntry{0, "No error"}));
  EXPECT_EQ(*parse_error_entry("-222,\"Data out of range;9,5\""), (ErrorEntry{-222, "Data out of range;9,5"}));
}

TEST(Scpi, RefusesWhatIsNoEntryOfTheErrorQueue) {
  for (const char* text : {"", "-113", "-113,Undefined", "x,\"y\"", "1,\"a\",2", "40000,\"a\"", "1.5,\"a\""}) {
    SCOPED_TRACE(text);
    EXPECT_EQ(parse_error_entry(text).error().code, ErrorCode::BadReply);
  }
}

TEST(Scpi, WritesEntriesOfTheErrorQueue) {
  EXPECT_EQ(format_error_entry({-113, "Undefined header"}), "-113,\"Undefined header\"");
  EXPECT_EQ(format_error_entry({0, "No error"}), "+0,\"No error\"");
}

TEST(Scpi, ShowsNoControlCharactersAndNoNovelsInItsErrors) {
  std::string text(500, 'a');
  text[3] = '\x1b';

  const auto number = parse_number(text);

  ASSERT_FALSE(number);
  EXPECT_EQ(number.error().seen, "\"aaa?" + std::string(36, 'a') + "...\"");
}

}  // namespace
}  // namespace gonio::scpi
