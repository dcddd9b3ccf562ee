#include "protocol/usbtmc/scpi.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace gonio::scpi {
namespace {

constexpr double kNotANumber = 9.91e37;
constexpr double kInfinity = 9.9e37;
constexpr std::size_t kMostShown = 40;  // of a reply, in a message

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// A reply as a message can show it: short, without control characters.
std::string shown(std::string_view text) {
  std::string clean(text.substr(0, kMostShown));
  std::ranges::replace_if(
      clean, [](char c) { return c < ' ' || c > '~'; }, '?');
  return "\"" + clean + (text.size() > kMostShown ? "...\"" : "\"");
}

tl::unexpected<Error> not_a(std::string_view what, std::string_view text) {
  return failure({.code = ErrorCode::BadReply,
                  .device = {},
                  .tried = fmt::format("read {}", what),
                  .seen = shown(text),
                  .limit = {}});
}

// [sign] digits [. digits] [E [sign] digits] with a digit on at least one side of the point.
bool is_decimal(std::string_view text) {
  std::size_t at = 0;
  const auto skip_sign = [&] { at += at < text.size() && (text[at] == '+' || text[at] == '-') ? 1U : 0U; };
  const auto skip_digits = [&] {
    const std::size_t from = at;
    while (at < text.size() && is_digit(text[at])) ++at;
    return at - from;
  };
  skip_sign();
  std::size_t digits = skip_digits();
  if (at < text.size() && text[at] == '.') {
    ++at;
    digits += skip_digits();
  }
  if (digits == 0) return false;
  if (at < text.size() && (text[at] == 'E' || text[at] == 'e')) {
    ++at;
    skip_sign();
    if (skip_digits() == 0) return false;
  }
  return at == text.size();
}

NumberKind kind_of(double value) {
  // A device prints them with some digits: 9.91E37, 9.910000E+37.
  const auto is = [&](double special) { return std::abs(value - special) <= 1e-4 * kInfinity; };
  if (is(kNotANumber)) return NumberKind::NotANumber;
  if (value >= kInfinity || is(kInfinity)) return NumberKind::Infinity;
  if (value <= -kInfinity || is(-kInfinity)) return NumberKind::NegativeInfinity;
  return NumberKind::Finite;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

Result<std::vector<std::string>> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  const std::string_view whole = trimmed(text);
  if (whole.empty()) return parts;
  char quote = '\0';
  std::size_t from = 0;
  for (std::size_t at = 0; at <= whole.size(); ++at) {
    const bool is_end = at == whole.size();
    if (!is_end && quote != '\0') {
      if (whole[at] == quote) quote = '\0';  // a doubled one opens again with the next character
    } else if (is_end || whole[at] == separator) {
      const std::string_view part = trimmed(whole.substr(from, at - from));
      if (part.empty()) return not_a(fmt::format("a text in parts by '{}'", separator), whole);
      parts.emplace_back(part);
      from = at + 1;
    } else if (whole[at] == '"' || whole[at] == '\'') {
      quote = whole[at];
    }
  }
  if (quote != '\0') return not_a("a text with its quotes closed", whole);
  return parts;
}

Result<Number> parse_number(std::string_view text) {
  std::string_view digits = trimmed(text);
  if (!is_decimal(digits)) return not_a("a number", digits);
  if (digits.front() == '+') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, trouble] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (trouble == std::errc::result_out_of_range) return not_a("a number that a double holds", digits);
  if (trouble != std::errc() || end != digits.data() + digits.size()) return not_a("a number", digits);
  return Number{.kind = kind_of(value), .value = value};
}

Result<double> parse_reading(std::string_view text) {
  const Result<Number> number = parse_number(text);
  if (!number) return failure(number.error());
  switch (number->kind) {
    case NumberKind::Finite:
      return number->value;
    case NumberKind::NotANumber:
      return not_a("a reading (this says \"not a number\")", trimmed(text));
    case NumberKind::Infinity:
    case NumberKind::NegativeInfinity:
      break;
  }
  return failure({.code = ErrorCode::Saturated,
                  .device = {},
                  .tried = "read a reading",
                  .seen = shown(trimmed(text)) + ", which says overload",
                  .limit = {}});
}

Result<std::int64_t> parse_integer(std::string_view text) {
  std::string_view digits = trimmed(text);
  if (!is_decimal(digits)) return not_a("a whole number", digits);
  if (digits.front() == '+') digits.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, trouble] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (trouble != std::errc() || end != digits.data() + digits.size()) return not_a("a whole number", digits);
  return value;
}

Result<bool> parse_flag(std::string_view text) {
  const std::string_view word = trimmed(text);
  if (word == "1" || word == "ON" || word == "on") return true;
  if (word == "0" || word == "OFF" || word == "off") return false;
  return not_a("a flag (0, 1, OFF, ON)", word);
}

Result<std::string> parse_quoted(std::string_view text) {
  const std::string_view whole = trimmed(text);
  const bool is_open = !whole.empty() && (whole.front() == '"' || whole.front() == '\'');
  if (!is_open || whole.size() < 2 || whole.back() != whole.front()) return not_a("a quoted text", whole);
  const char quote = whole.front();
  const std::string_view inner = whole.substr(1, whole.size() - 2);
  std::string plain;
  for (std::size_t at = 0; at < inner.size(); ++at) {
    if (inner[at] == quote) {
      if (at + 1 >= inner.size() || inner[at + 1] != quote) return not_a("a quoted text", whole);
      ++at;
    }
    plain += inner[at];
  }
  return plain;
}

std::string quoted(std::string_view text) {
  std::string whole = "\"";
  for (const char c : text) whole += c == '"' ? std::string("\"\"") : std::string(1, c);
  return whole + "\"";
}

Result<ErrorEntry> parse_error_entry(std::string_view text) {
  constexpr std::int64_t kMostCode = 32767;
  const auto parts = split(text, ',');
  if (!parts || parts->size() != 2) return not_a("an entry of the error queue", trimmed(text));
  const auto code = parse_integer(parts->front());
  const auto words = parse_quoted(parts->back());
  if (!code || !words || *code < -kMostCode - 1 || *code > kMostCode) {
    return not_a("an entry of the error queue", trimmed(text));
  }
  return ErrorEntry{.code = static_cast<int>(*code), .text = *words};
}

std::string format_error_entry(const ErrorEntry& entry) {
  return fmt::format("{:+d},{}", entry.code, quoted(entry.text));
}

}  // namespace gonio::scpi
