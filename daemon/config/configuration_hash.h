#pragma once

#include <string>
#include <string_view>

#include "base/toml_reader.h"

namespace gonio::daemon {

/// SHA-256 of a text, as 64 hex digits.
[[nodiscard]] std::string sha256_hex(std::string_view text);

/// The hash of an instrument's text without the lines that only say where a device answers: `address` and `port` of
/// [stage] and `address` of [detector]. Moving a cable does not change an instrument; everything else does, comments
/// included. An address that shares its line with other keys stays in.
[[nodiscard]] std::string configuration_hash(const TomlReader& root, std::string_view text);

}  // namespace gonio::daemon
