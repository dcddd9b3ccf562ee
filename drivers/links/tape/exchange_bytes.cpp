#include "drivers/links/tape/exchange_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "drivers/links/tape/tape_bytes.h"

namespace gonio::drivers {
namespace {

constexpr std::size_t kMostShown = 32;  // words or bytes of a request, in a sentence

tl::unexpected<Error> not_that(std::string what) {
  return failure({.code = ErrorCode::IncompleteData,
                  .device = "tape",
                  .tried = "read " + std::move(what),
                  .seen = "the reply on the tape has another size",
                  .limit = {}});
}

std::string hex_words(ByteReader& in, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint16_t word = in.u16();
    if (i < kMostShown) text += fmt::format(" 0x{:04X}", word);
  }
  return count > kMostShown ? text + " ..." : text;
}

std::string hex_bytes(std::span<const std::uint8_t> bytes) {
  std::string text;
  std::string letters;
  for (const std::uint8_t byte : bytes.first(std::min(bytes.size(), 2 * kMostShown))) {
    text += fmt::format(" {:02X}", byte);
    letters += std::isprint(byte) != 0 ? static_cast<char>(byte) : '.';
  }
  return fmt::format("{} bytes:{} \"{}\"", bytes.size(), text, letters);
}

std::string modbus_in_words(TapeCall call, std::span<const std::uint8_t> request) {
  ByteReader in(request);
  const std::uint16_t first = in.u16();
  const std::uint16_t count = in.u16();
  if (call == TapeCall::ReadRegisters) return fmt::format("read {} registers from {}", count, first);
  const std::string write = fmt::format("write {} registers from {}:{}", count, first, hex_words(in, count));
  if (call == TapeCall::WriteRegisters) return write;
  const std::uint16_t read_first = in.u16();
  return fmt::format("{}, read {} registers from {}", write, in.u16(), read_first);
}

}  // namespace

std::vector<std::uint8_t> request_to_read(std::uint16_t first, std::size_t count) {
  return ByteWriter().u16(first).u16(static_cast<std::uint16_t>(count)).take();
}

std::vector<std::uint8_t> request_to_write(std::uint16_t first, std::span<const std::uint16_t> words) {
  return ByteWriter().u16(first).u16(static_cast<std::uint16_t>(words.size())).words(words).take();
}

std::vector<std::uint8_t> request_to_write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                                    std::uint16_t read_first, std::size_t count) {
  return ByteWriter()
      .u16(write_first)
      .u16(static_cast<std::uint16_t>(words.size()))
      .words(words)
      .u16(read_first)
      .u16(static_cast<std::uint16_t>(count))
      .take();
}

std::vector<std::uint8_t> bytes_of(std::span<const std::uint16_t> words) {
  return ByteWriter().words(words).take();
}

Result<void> read_words(std::span<const std::uint8_t> reply, std::span<std::uint16_t> into) {
  if (reply.size() != 2 * into.size()) return not_that("registers");
  ByteReader in(reply);
  std::ranges::copy(in.words(), into.begin());
  return {};
}

std::vector<std::uint8_t> bytes_of(const DetectorIdentity& identity) {
  return ByteWriter().text(identity.vendor).text(identity.model).text(identity.serial).take();
}

Result<DetectorIdentity> read_identity(std::span<const std::uint8_t> reply) {
  ByteReader in(reply);
  DetectorIdentity identity;
  identity.vendor = in.text();
  identity.model = in.text();
  identity.serial = in.text();
  if (!in.is_done()) return not_that("who the device is");
  return identity;
}

std::vector<std::uint8_t> bytes_of(const CameraFormat& format) {
  return ByteWriter()
      .i64(format.width)
      .i64(format.height)
      .i64(format.offset_x)
      .i64(format.offset_y)
      .text(format.pixel_format)
      .i64(format.packet_size_bytes)
      .take();
}

Result<CameraFormat> read_format(std::span<const std::uint8_t> reply) {
  ByteReader in(reply);
  CameraFormat format;
  format.width = static_cast<int>(in.i64());
  format.height = static_cast<int>(in.i64());
  format.offset_x = static_cast<int>(in.i64());
  format.offset_y = static_cast<int>(in.i64());
  format.pixel_format = in.text();
  format.packet_size_bytes = static_cast<int>(in.i64());
  if (!in.is_done()) return not_that("a format");
  return format;
}

std::vector<std::uint8_t> bytes_of(const ExposureSettings& settings) {
  return ByteWriter().i64(settings.exposure.count()).f64(settings.gain_db).take();
}

Result<ExposureSettings> read_exposure(std::span<const std::uint8_t> reply) {
  ByteReader in(reply);
  ExposureSettings settings{.exposure = Duration(in.i64())};
  settings.gain_db = in.f64();
  if (!in.is_done()) return not_that("an exposure");
  return settings;
}

std::vector<std::uint8_t> bytes_of(const std::optional<double>& value) {
  if (!value) return {};
  return ByteWriter().f64(*value).take();
}

Result<std::optional<double>> read_number(std::span<const std::uint8_t> reply) {
  if (reply.empty()) return std::optional<double>();
  ByteReader in(reply);
  const double value = in.f64();
  if (!in.is_done()) return not_that("a number");
  return std::optional<double>(value);
}

std::vector<std::uint8_t> bytes_of(bool value) {
  return {static_cast<std::uint8_t>(value ? 1 : 0)};
}

bool read_flag(std::span<const std::uint8_t> reply) {
  return !reply.empty() && reply[0] != 0;
}

std::vector<std::uint8_t> bytes_of(const std::optional<CameraFrame>& frame) {
  if (!frame) return {};
  return ByteWriter()
      .u8(frame->is_complete ? 1 : 0)
      .text(frame->trouble)
      .i64(frame->width)
      .i64(frame->height)
      .i64(static_cast<std::int64_t>(frame->frame_id))
      .i64(static_cast<std::int64_t>(frame->camera_time_ns))
      .take();
}

Result<std::optional<CameraFrame>> read_frame(const TapeExchange& exchange) {
  if (exchange.reply.empty()) return std::optional<CameraFrame>();
  ByteReader in(exchange.reply);
  CameraFrame frame;
  frame.is_complete = in.u8() != 0;
  frame.trouble = in.text();
  frame.width = static_cast<int>(in.i64());
  frame.height = static_cast<int>(in.i64());
  frame.frame_id = static_cast<std::uint64_t>(in.i64());
  frame.camera_time_ns = static_cast<std::uint64_t>(in.i64());
  if (!in.is_done()) return not_that("a frame");
  frame.pixels = exchange.pixels;
  return std::optional<CameraFrame>(std::move(frame));
}

std::vector<std::uint8_t> bytes_of(const UsbtmcInterface& interface) {
  return {interface.number, interface.bulk_out, interface.bulk_in, interface.interrupt_in};
}

Result<UsbtmcInterface> read_interface(std::span<const std::uint8_t> reply) {
  if (reply.size() != 4) return not_that("an interface");
  return UsbtmcInterface{.number = reply[0], .bulk_out = reply[1], .bulk_in = reply[2], .interrupt_in = reply[3]};
}

std::vector<std::uint8_t> bytes_of(const usbtmc::ControlRequest& request) {
  return ByteWriter()
      .u8(request.request_type)
      .u8(static_cast<std::uint8_t>(request.request))
      .u16(request.value)
      .u16(request.index)
      .u16(request.length)
      .take();
}

std::vector<std::uint8_t> request_for(std::size_t most) {
  return ByteWriter().u32(static_cast<std::uint32_t>(most)).take();
}

std::string in_words(TapeCall call, std::span<const std::uint8_t> request) {
  const std::string name(tape_call_name(call));
  switch (call) {
    case TapeCall::ReadRegisters:
    case TapeCall::WriteRegisters:
    case TapeCall::WriteAndRead:
      return modbus_in_words(call, request);
    case TapeCall::CameraSetExposure:
      if (const auto settings = read_exposure(request)) {
        return fmt::format("{} to {:.6f} s, gain {:.2f} dB", name, in_seconds(settings->exposure), settings->gain_db);
      }
      return name;
    case TapeCall::CameraSetFormat:
      if (const auto format = read_format(request)) {
        return fmt::format("{} to {} x {} px at ({}, {}), {}, packets of {} bytes", name, format->width, format->height,
                           format->offset_x, format->offset_y, format->pixel_format, format->packet_size_bytes);
      }
      return name;
    case TapeCall::UsbBulkOut:
    case TapeCall::UsbBulkIn:
    case TapeCall::UsbControlIn:
    case TapeCall::UsbClearHalt:
      return name + ", " + hex_bytes(request);
    default:
      return name;
  }
}

}  // namespace gonio::drivers
