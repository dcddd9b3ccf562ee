#pragma once

#include <stdexcept>
#include <string>

#include "base/error.h"

namespace gonio::fuzz {

/// What the code under test does not keep. To libFuzzer a crash, to the replay of the corpus a failed test.
class BrokenPromise : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws BrokenPromise with these words unless it is kept.
void hold(bool is_kept, const std::string& promise);

/// Of every error: one sentence without a line's end or another control character, and it says what was seen.
void hold_error(const Error& error);
/// Also who, and what was tried: an error of a device.
void hold_device_error(const Error& error);
/// Also where: an error in a text that a user wrote, in `file`, at a line that it has.
void hold_input_error(const Error& error, const std::string& file, std::string_view text);

}  // namespace gonio::fuzz
