#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "base/toml_reader.h"
#include "protocol/stage/drive_map.h"

namespace gonio::stage {

// Parts that the maps of registers, of drives and of couplers share; inside of this room only.

using Functions = std::pair<ReadFunction, WriteFunction>;

/// The inline table `name` of `table`: address, words, signed, low_word_first.
[[nodiscard]] Register read_plain_register(TomlReader& table, std::string_view name);
/// The same keys, of a table that has others beside them.
[[nodiscard]] Register read_register_here(TomlReader& entry);
[[nodiscard]] std::string register_keys(const Register& reg);

/// `read_registers` and `write_register`.
[[nodiscard]] Functions read_functions(TomlReader& table, WriteFunction usual);
[[nodiscard]] std::string functions_text(ReadFunction reads, WriteFunction writes);

}  // namespace gonio::stage
