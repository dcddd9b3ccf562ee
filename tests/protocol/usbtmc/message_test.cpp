// Bytes written from the tables of USBTMC 1.0: 1 (header), 3 (command), 4 (request for data), 9 (reply).
#include "protocol/usbtmc/message.h"

#include <gtest/gtest.h>

#include <string_view>

namespace gonio::usbtmc {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

// "*IDN?" under tag 1: 5 bytes of data, EOM, 3 bytes of fill.
const Bytes kIdentify{0x01, 0x01, 0xFE, 0x00, 0x05, 0x00, 0x00, 0x00, 0x01, 0x00,
                      0x00, 0x00, '*',  'I',  'D',  'N',  '?',  0x00, 0x00, 0x00};
// "At most 1024 bytes" under tag 2.
const Bytes kRequest{0x02, 0x02, 0xFD, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
// The reply "1.5\n" under tag 2: 4 bytes, EOM.
const Bytes kReply{0x02, 0x02, 0xFD, 0x00, 0x04, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, '1', '.', '5', '\n'};

TEST(UsbtmcMessage, PutsACommandInItsHeaderAndFillsItUpToFourBytes) {
  EXPECT_EQ(dev_dep_msg_out(1, bytes_of("*IDN?"), true), kIdentify);
}

TEST(UsbtmcMessage, AddsNoFillToACommandThatEndsOnFourBytes) {
  const Bytes expected{0x01, 0xFF, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, '*', 'C', 'L', 'S'};

  EXPECT_EQ(dev_dep_msg_out(255, bytes_of("*CLS"), false), expected);
}

TEST(UsbtmcMessage, AsksForDataWithALimitLowByteFirst) {
  const auto request = request_dev_dep_msg_in(2, 1024);

  EXPECT_EQ(Bytes(request.begin(), request.end()), kRequest);
}

TEST(UsbtmcMessage, NamesTheCharacterAtWhichADeviceShallStop) {
  const auto request = request_dev_dep_msg_in(3, 0x01020304, '\n');

  EXPECT_EQ(Bytes(request.begin(), request.end()),
            (Bytes{0x02, 0x03, 0xFC, 0x00, 0x04, 0x03, 0x02, 0x01, 0x02, 0x0A, 0x00, 0x00}));
}

TEST(UsbtmcMessage, PutsAReplyInItsHeader) {
  EXPECT_EQ(dev_dep_msg_in(2, bytes_of("1.5\n"), true), kReply);
}

TEST(UsbtmcMessage, NamesTransfersFrom1To255AndNever0) {
  TagSequence tags;

  for (int expected = 1; expected <= 255; ++expected) EXPECT_EQ(tags.next(), expected);
  EXPECT_EQ(tags.next(), 1);
}

TEST(UsbtmcMessage, IsReadByTheDeviceAsACommand) {
  const auto out = parse_bulk_out(kIdentify);

  ASSERT_TRUE(out) << describe(out.error());
  EXPECT_EQ(out->id, MessageId::DevDepMsgOut);
  EXPECT_EQ(out->tag, 1);
  EXPECT_TRUE(out->is_end);
  EXPECT_EQ(out->payload, bytes_of("*IDN?"));
}

TEST(UsbtmcMessage, IsReadByTheDeviceAsARequest) {
  Bytes bytes = kRequest;

  auto out = parse_bulk_out(bytes);
  ASSERT_TRUE(out) << describe(out.error());
  EXPECT_EQ(out->id, MessageId::DevDepMsgIn);
  EXPECT_EQ(out->most, 1024U);
  EXPECT_FALSE(out->stop_at);

  bytes[8] = 0x02;
  bytes[9] = 0x0A;
  out = parse_bulk_out(bytes);
  ASSERT_TRUE(out);
  EXPECT_EQ(out->stop_at, '\n');
}

TEST(UsbtmcMessage, IsReadByTheDeviceAsATrigger) {
  const auto out = parse_bulk_out(Bytes{128, 7, 0xF8, 0, 0, 0, 0, 0, 0, 0, 0, 0});

  ASSERT_TRUE(out) << describe(out.error());
  EXPECT_EQ(out->id, MessageId::Trigger);
  EXPECT_EQ(out->tag, 7);
}

TEST(UsbtmcMessage, IsReadByTheHostAsAReply) {
  const auto in = parse_dev_dep_msg_in(kReply, 2, 1024);

  ASSERT_TRUE(in) << describe(in.error());
  EXPECT_TRUE(in->is_end);
  EXPECT_EQ(in->payload, bytes_of("1.5\n"));
}

TEST(UsbtmcMessage, MayHaveFillBehindAReply) {
  Bytes filled = kReply;
  filled.resize(kReply.size() + 511, 0xAA);
  const auto in = parse_dev_dep_msg_in(filled, 2, 1024);
  ASSERT_TRUE(in) << describe(in.error());
  EXPECT_EQ(in->payload, bytes_of("1.5\n"));

  filled.push_back(0xAA);
  EXPECT_EQ(parse_dev_dep_msg_in(filled, 2, 1024).error().code, ErrorCode::BadReply);
}

struct Damage {
  const char* what;
  std::size_t at;
  std::uint8_t byte;
  ErrorCode code;
};

TEST(UsbtmcMessage, IsRefusedByTheHostWhenItsHeaderIsNotWhatWasAskedFor) {
  for (const Damage& d : {Damage{"another message", 0, 0x01, ErrorCode::BadReply},
                          Damage{"a tag without its inverse", 1, 0x03, ErrorCode::BadReply},
                          Damage{"an inverse without its tag", 2, 0xFC, ErrorCode::BadReply},
                          Damage{"more data than there are", 4, 0x05, ErrorCode::IncompleteData},
                          Damage{"no data", 4, 0x00, ErrorCode::BadReply},
                          Damage{"more data than asked for", 6, 0x01, ErrorCode::BadReply}}) {
    SCOPED_TRACE(d.what);
    Bytes bytes = kReply;
    bytes[d.at] = d.byte;

    const auto in = parse_dev_dep_msg_in(bytes, 2, 1024);

    ASSERT_FALSE(in);
    EXPECT_EQ(in.error().code, d.code) << describe(in.error());
  }
}

TEST(UsbtmcMessage, IsStaleWhenItBearsAnotherTag) {
  const auto in = parse_dev_dep_msg_in(kReply, 3, 1024);

  ASSERT_FALSE(in);
  EXPECT_EQ(in.error().code, ErrorCode::StaleData);
  EXPECT_EQ(in.error().seen, "tag 2");
  EXPECT_EQ(in.error().limit, "tag 3");
}

TEST(UsbtmcMessage, IsIncompleteAtEveryLengthButItsOwn) {
  for (std::size_t length = 0; length < kReply.size(); ++length) {
    SCOPED_TRACE(length);

    const auto in = parse_dev_dep_msg_in(std::span(kReply).first(length), 2, 1024);

    ASSERT_FALSE(in);
    EXPECT_EQ(in.error().code, ErrorCode::IncompleteData);
  }
}

TEST(UsbtmcMessage, IsRefusedByTheDeviceWhenItIsNotWellMade) {
  const auto code_of = [](Bytes bytes) {
    const auto out = parse_bulk_out(bytes);
    return out ? ErrorCode::Internal : out.error().code;
  };
  Bytes bytes = kIdentify;
  bytes.pop_back();
  EXPECT_EQ(code_of(bytes), ErrorCode::BadReply) << "not filled up";
  bytes.resize(14);
  EXPECT_EQ(code_of(bytes), ErrorCode::IncompleteData) << "fewer bytes than its size says";
  bytes = kIdentify;
  bytes[1] = 0;
  bytes[2] = 0xFF;
  EXPECT_EQ(code_of(bytes), ErrorCode::BadReply) << "tag 0";
  bytes = kIdentify;
  bytes[0] = 9;
  EXPECT_EQ(code_of(bytes), ErrorCode::BadReply) << "unknown message";
  bytes = kIdentify;
  bytes[7] = 0x80;
  EXPECT_EQ(code_of(bytes), ErrorCode::BadReply) << "2 GiB";
  bytes = kRequest;
  bytes[5] = 0;
  EXPECT_EQ(code_of(bytes), ErrorCode::BadReply) << "a request for nothing";
  EXPECT_EQ(code_of({0x01, 0x01, 0xFE}), ErrorCode::IncompleteData);
}

}  // namespace
}  // namespace gonio::usbtmc
