#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/clock.h"
#include "base/error.h"

namespace gonio::drivers {

/// Whose turn, exchange or clock reading a record is: one thread of the daemon each.
enum class TapeParty : std::uint8_t { Stage = 1, Halt = 2, Detector = 3, Monitor = 4, Sequencer = 5, Store = 6 };
inline constexpr int kTapePartyCount = 6;
/// "stage", "halt line", "detector" ...
[[nodiscard]] std::string_view tape_party_name(TapeParty party);

/// What was asked of a link. Numbers are part of the format: never changed, never used again.
enum class TapeCall : std::uint8_t {
  ReadRegisters = 1,
  WriteRegisters = 2,
  WriteAndRead = 3,
  Resync = 4,
  CameraOpen = 16,
  CameraClose = 17,
  CameraIsOpen = 18,
  CameraHasLostControl = 19,
  CameraSetFormat = 20,
  CameraFormatRead = 21,
  CameraSetExposure = 22,
  CameraExposureRead = 23,
  CameraTemperature = 24,
  CameraStart = 25,
  CameraStop = 26,
  CameraIsStreaming = 27,
  CameraTrigger = 28,
  CameraPop = 29,
  UsbOpen = 48,
  UsbClose = 49,
  UsbIsOpen = 50,
  UsbInterface = 51,
  UsbBulkOut = 52,
  UsbBulkIn = 53,
  UsbInterruptIn = 54,
  UsbControlIn = 55,
  UsbClearHalt = 56,
};
/// "read registers"; empty for a number that is none.
[[nodiscard]] std::string_view tape_call_name(TapeCall call);
/// A question to the link about itself: nothing goes over a wire, and a program that asks it oftener is no other.
[[nodiscard]] bool is_a_query(TapeCall call);

/// The first record: what a replay has to be built from.
struct TapeStart {
  std::string program_version;
  std::string instrument_text;     ///< instrument.toml, verbatim
  std::string configuration_hash;  ///< of what counts in it
  std::string boot_id;
  UtcTime utc{};  ///< at `boottime`
  Instant boottime{};
  std::int64_t last_event = 0;  ///< of the store that the recording began on; 0: an empty one
  friend bool operator==(const TapeStart&, const TapeStart&) = default;
};

/// A party was given something to do, or looked whether there was: everything that it did until its next turn follows
/// from this, from what the devices replied, and from its clock readings.
struct TapeTurn {
  TapeParty party = TapeParty::Stage;
  /// What it was given; the recording program's own numbers. 0: nothing, it was its time.
  std::uint8_t source = 0;
  Instant now{};
  std::int64_t argument = 0;  ///< of calls that have one: a halt's epoch, a watch's timeout
  friend bool operator==(const TapeTurn&, const TapeTurn&) = default;
};

/// One call of a link: request and reply as bytes, or the error in its place.
struct TapeExchange {
  TapeParty party = TapeParty::Stage;
  std::uint8_t link = 0;  ///< of a party that has several
  TapeCall call = TapeCall::ReadRegisters;
  Instant asked{};
  Instant answered{};
  std::vector<std::uint8_t> request;
  std::optional<Error> error;
  std::vector<std::uint8_t> reply;
  std::vector<std::uint16_t> pixels;  ///< of a frame; on the tape they are packed
  friend bool operator==(const TapeExchange&, const TapeExchange&) = default;
};

/// What came from outside and not from a device: a client's command, a STOP. The recording program's own words.
struct TapeInput {
  std::string kind;
  std::string text;
  friend bool operator==(const TapeInput&, const TapeInput&) = default;
};

/// A clock was read. Nanoseconds since boot, or (`is_utc`) since 1970.
struct TapeReading {
  TapeParty party = TapeParty::Stage;
  bool is_utc = false;
  std::int64_t ns = 0;
  friend bool operator==(const TapeReading&, const TapeReading&) = default;
};

/// The last record of a recording that was ended and not cut off.
struct TapeEnd {
  std::string reason;  ///< "ended", or why it could not go on
  friend bool operator==(const TapeEnd&, const TapeEnd&) = default;
};

using TapeRecord = std::variant<TapeStart, TapeTurn, TapeExchange, TapeInput, TapeReading, TapeEnd>;

}  // namespace gonio::drivers
