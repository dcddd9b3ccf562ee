#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace gonio::scpi {

/// The parts of a message between `separator`s that stand outside of quotes, without the blanks around them: commands
/// by ';', arguments by ','. Quotes are ' or ", doubled inside of themselves. An empty text has no parts.
/// Errors: BadReply (a quote is not closed, or a part is empty).
[[nodiscard]] Result<std::vector<std::string>> split(std::string_view text, char separator);

/// What a number can say (SCPI-99, volume 1, 7.2.1): 9.91E37 is "not a number", 9.9E37 and its negative are infinities.
enum class NumberKind : std::uint8_t { Finite, NotANumber, Infinity, NegativeInfinity };
struct Number {
  NumberKind kind = NumberKind::Finite;
  double value = 0.0;  ///< meaningless unless finite
  friend bool operator==(const Number&, const Number&) = default;
};

/// One decimal number, whole or with a point or with an exponent (NR1, NR2, NR3 of IEEE 488.2-1992, 8.7), and nothing
/// else: no unit, no blank inside, no hexadecimal, no "inf". Blanks around it and the end of the line are passed over.
/// Errors: BadReply.
[[nodiscard]] Result<Number> parse_number(std::string_view text);
/// As `parse_number`; what is no reading is an error too: BadReply for "not a number", Saturated for an infinity.
[[nodiscard]] Result<double> parse_reading(std::string_view text);
/// A whole number. Errors: BadReply.
[[nodiscard]] Result<std::int64_t> parse_integer(std::string_view text);
/// 0, 1, OFF or ON. Errors: BadReply.
[[nodiscard]] Result<bool> parse_flag(std::string_view text);

/// A quoted text without its quotes. Errors: BadReply (not quoted, or quotes inside that are not doubled).
[[nodiscard]] Result<std::string> parse_quoted(std::string_view text);
[[nodiscard]] std::string quoted(std::string_view text);

/// One entry of a device's error queue; code 0 says that it is empty (SCPI-99, volume 2, 21.8).
struct ErrorEntry {
  int code = 0;
  std::string text;
  friend bool operator==(const ErrorEntry&, const ErrorEntry&) = default;
};
/// `-113,"Undefined header"`. Errors: BadReply (also for a code outside of -32768 to 32767).
[[nodiscard]] Result<ErrorEntry> parse_error_entry(std::string_view text);
[[nodiscard]] std::string format_error_entry(const ErrorEntry& entry);

/// The text without blanks and line ends around it.
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace gonio::scpi
