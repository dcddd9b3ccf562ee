#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "drivers/links/camera_link.h"
#include "drivers/links/tape/tape_record.h"
#include "drivers/links/usbtmc_link.h"

// Requests and replies of the links as the tape has them (README.md, "Calls"): one function to make the bytes and one
// to read them. What cannot be read is IncompleteData.
namespace gonio::drivers {

[[nodiscard]] std::vector<std::uint8_t> request_to_read(std::uint16_t first, std::size_t count);
[[nodiscard]] std::vector<std::uint8_t> request_to_write(std::uint16_t first, std::span<const std::uint16_t> words);
[[nodiscard]] std::vector<std::uint8_t> request_to_write_and_read(std::uint16_t write_first,
                                                                  std::span<const std::uint16_t> words,
                                                                  std::uint16_t read_first, std::size_t count);
[[nodiscard]] std::vector<std::uint8_t> bytes_of(std::span<const std::uint16_t> words);
/// Exactly as many words as `into` has.
[[nodiscard]] Result<void> read_words(std::span<const std::uint8_t> reply, std::span<std::uint16_t> into);

[[nodiscard]] std::vector<std::uint8_t> bytes_of(const DetectorIdentity& identity);
[[nodiscard]] Result<DetectorIdentity> read_identity(std::span<const std::uint8_t> reply);
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const CameraFormat& format);
[[nodiscard]] Result<CameraFormat> read_format(std::span<const std::uint8_t> reply);
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const ExposureSettings& settings);
[[nodiscard]] Result<ExposureSettings> read_exposure(std::span<const std::uint8_t> reply);
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const std::optional<double>& value);
/// Empty: there is none.
[[nodiscard]] Result<std::optional<double>> read_number(std::span<const std::uint8_t> reply);
[[nodiscard]] std::vector<std::uint8_t> bytes_of(bool value);
[[nodiscard]] bool read_flag(std::span<const std::uint8_t> reply);

/// A frame without its pixels, which an exchange has in a field of their own; nothing: an empty reply.
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const std::optional<CameraFrame>& frame);
[[nodiscard]] Result<std::optional<CameraFrame>> read_frame(const TapeExchange& exchange);

[[nodiscard]] std::vector<std::uint8_t> bytes_of(const UsbtmcInterface& interface);
[[nodiscard]] Result<UsbtmcInterface> read_interface(std::span<const std::uint8_t> reply);
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const usbtmc::ControlRequest& request);
/// How much may come: what a bulk-in transfer asks for.
[[nodiscard]] std::vector<std::uint8_t> request_for(std::size_t most);

/// What an exchange asks for, in words: "write 3 registers from 128: 0x0001 0x0002 0x0003".
[[nodiscard]] std::string in_words(TapeCall call, std::span<const std::uint8_t> request);

}  // namespace gonio::drivers
