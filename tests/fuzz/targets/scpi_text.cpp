// What a meter says, as text: numbers, quoted texts, lists, entries of its error queue.
#include <cmath>
#include <cstdlib>
#include <string>

#include "protocol/usbtmc/scpi.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

template <class T>
void hold_refusal(const Result<T>& result) {
  if (!result) hold_error(result.error());
}

void check_number(std::string_view text) {
  const auto number = scpi::parse_number(text);
  hold_refusal(number);
  if (number && number->kind == scpi::NumberKind::Finite) {
    const std::string plain(scpi::trimmed(text));
    hold(std::isfinite(number->value), "a finite number is finite");
    hold(number->value == std::strtod(plain.c_str(), nullptr),
         "a number is the one that the C library reads: " + plain);
  }
  const auto reading = scpi::parse_reading(text);
  hold_refusal(reading);
  hold(reading.has_value() == (number && number->kind == scpi::NumberKind::Finite), "a reading is a finite number");
  const auto integer = scpi::parse_integer(text);
  hold_refusal(integer);
  if (integer) hold(number.has_value(), "a whole number is a number");
  hold_refusal(scpi::parse_flag(text));
}

void check_texts(std::string_view text) {
  const auto unquoted = scpi::parse_quoted(scpi::quoted(text));
  hold(unquoted && *unquoted == text, "a text that is quoted reads back");
  hold_refusal(scpi::parse_quoted(text));
  for (const char separator : {',', ';'}) {
    const auto parts = scpi::split(text, separator);
    hold_refusal(parts);
    if (!parts) continue;
    for (const std::string& part : *parts)
      hold(!part.empty() && part == scpi::trimmed(part), "a part is not empty and has no blanks about it");
  }
  const auto entry = scpi::parse_error_entry(text);
  hold_refusal(entry);
  if (!entry) return;
  const auto same = scpi::parse_error_entry(scpi::format_error_entry(*entry));
  hold(same && *same == *entry, "an entry written again is the same");
}

}  // namespace

void scpi_text(Bytes input) {
  const std::string_view text = text_of(input);
  check_number(text);
  check_texts(text);
}

}  // namespace gonio::fuzz
