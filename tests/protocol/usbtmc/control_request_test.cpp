// Bytes written from USBTMC 1.0, tables 17 to 37, and USB488 1.0, tables 8 to 11.
#include "protocol/usbtmc/control_request.h"

#include <gtest/gtest.h>

namespace gonio::usbtmc {
namespace {

using SetupBytes = std::array<std::uint8_t, 8>;

TEST(UsbtmcControl, HasTheSetupBytesOfTheStandard) {
  EXPECT_EQ(setup_bytes(initiate_abort_bulk_out(0x01, 5)), (SetupBytes{0xA2, 1, 5, 0, 0x01, 0, 2, 0}));
  EXPECT_EQ(setup_bytes(check_abort_bulk_out_status(0x01)), (SetupBytes{0xA2, 2, 0, 0, 0x01, 0, 8, 0}));
  EXPECT_EQ(setup_bytes(initiate_abort_bulk_in(0x82, 255)), (SetupBytes{0xA2, 3, 255, 0, 0x82, 0, 2, 0}));
  EXPECT_EQ(setup_bytes(check_abort_bulk_in_status(0x82)), (SetupBytes{0xA2, 4, 0, 0, 0x82, 0, 8, 0}));
  EXPECT_EQ(setup_bytes(initiate_clear(3)), (SetupBytes{0xA1, 5, 0, 0, 3, 0, 1, 0}));
  EXPECT_EQ(setup_bytes(check_clear_status(3)), (SetupBytes{0xA1, 6, 0, 0, 3, 0, 2, 0}));
  EXPECT_EQ(setup_bytes(get_capabilities(0)), (SetupBytes{0xA1, 7, 0, 0, 0, 0, 24, 0}));
  EXPECT_EQ(setup_bytes(read_status_byte(0, 127)), (SetupBytes{0xA1, 128, 127, 0, 0, 0, 3, 0}));
}

TEST(UsbtmcControl, IsReadByTheDeviceFromItsSetupBytes) {
  EXPECT_EQ(parse_setup(SetupBytes{0xA2, 3, 255, 0, 0x82, 0, 2, 0}), initiate_abort_bulk_in(0x82, 255));
  EXPECT_EQ(parse_setup(SetupBytes{0x80, 6, 0x03, 0x02, 0x09, 0x04, 0xFF, 0x01}),
            (ControlRequest{.request_type = 0x80,
                            .request = static_cast<Request>(6),
                            .value = 0x0203,
                            .index = 0x0409,
                            .length = 0x01FF}));
}

TEST(UsbtmcControl, NamesStatusQueriesFrom2To127) {
  StatusTagSequence tags;

  for (int expected = 2; expected <= 127; ++expected) EXPECT_EQ(tags.next(), expected);
  EXPECT_EQ(tags.next(), 2);
}

TEST(UsbtmcControl, TellsHowFarAnAbortIs) {
  const auto pending = parse_progress(std::array<std::uint8_t, 8>{0x02, 0x01, 0, 0, 0x10, 0, 0, 0});
  ASSERT_TRUE(pending);
  EXPECT_EQ(pending->status, Status::Pending);
  EXPECT_TRUE(pending->has_data);

  const auto done = parse_progress(std::array<std::uint8_t, 2>{0x01, 0x00});
  ASSERT_TRUE(done);
  EXPECT_EQ(done->status, Status::Success);
  EXPECT_FALSE(done->has_data);

  EXPECT_EQ(parse_progress(std::array<std::uint8_t, 1>{0x01}).error().code, ErrorCode::IncompleteData);
}

TEST(UsbtmcControl, TellsAStatusOnlyWhereThereIsOne) {
  EXPECT_EQ(*parse_status(std::array<std::uint8_t, 2>{0x81, 7}), Status::TransferNotInProgress);
  EXPECT_EQ(parse_status({}).error().code, ErrorCode::IncompleteData);
}

// A USB488 interface with trigger and SCPI; the host may name a character at which to stop.
constexpr std::array<std::uint8_t, 24> kCapabilityBytes{0x01, 0,    0x00, 0x01, 0x00, 0x01, 0, 0, 0, 0, 0, 0,
                                                        0x00, 0x01, 0x05, 0x08, 0,    0,    0, 0, 0, 0, 0, 0};
constexpr Capabilities kCapabilities{.usbtmc_version = 0x0100,
                                     .stops_at_character = true,
                                     .usb488_version = 0x0100,
                                     .understands_488_2 = true,
                                     .takes_trigger = true,
                                     .understands_scpi = true};

TEST(UsbtmcControl, TellsWhatAnInterfaceCanDo) {
  const auto capabilities = parse_capabilities(kCapabilityBytes);

  ASSERT_TRUE(capabilities) << describe(capabilities.error());
  EXPECT_EQ(*capabilities, kCapabilities);
}

TEST(UsbtmcControl, PutsWhatAnInterfaceCanDoInto24Bytes) {
  EXPECT_EQ(capability_bytes(kCapabilities), kCapabilityBytes);
}

TEST(UsbtmcControl, RefusesCapabilitiesThatAreShortOrFailed) {
  EXPECT_EQ(parse_capabilities(std::span(kCapabilityBytes).first(23)).error().code, ErrorCode::IncompleteData);
  std::array<std::uint8_t, 24> failed = kCapabilityBytes;
  failed[0] = 0x80;
  EXPECT_EQ(parse_capabilities(failed).error().code, ErrorCode::DeviceRefused);
}

}  // namespace
}  // namespace gonio::usbtmc
