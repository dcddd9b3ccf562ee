#include "tests/fuzz/promise.h"

#include <algorithm>

namespace gonio::fuzz {

void hold(bool is_kept, const std::string& promise) {
  if (!is_kept) throw BrokenPromise(promise);
}

void hold_error(const Error& error) {
  const std::string sentence = describe(error);
  const bool is_one_line =
      std::ranges::none_of(sentence, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
  hold(is_one_line, "an error is one line: " + sentence);
  hold(!error.seen.empty(), "an error says what was seen: " + sentence);
}

void hold_device_error(const Error& error) {
  hold_error(error);
  hold(!error.device.empty(), "a device's error names it: " + describe(error));
  hold(!error.tried.empty(), "a device's error says what was tried: " + describe(error));
}

void hold_input_error(const Error& error, const std::string& file, std::string_view text) {
  hold_error(error);
  hold(error.where.has_value(), "an input's error says where: " + describe(error));
  hold(error.where->file == file, "an input's error names the user's file: " + describe(error));
  const auto lines = std::ranges::count(text, '\n') + 1;
  hold(error.where->line >= 0 && error.where->line <= lines, "the line exists: " + describe(error));
}

}  // namespace gonio::fuzz
