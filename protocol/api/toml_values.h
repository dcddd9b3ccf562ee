#pragma once

#include <string_view>
#include <vector>

#include "base/toml_reader.h"

namespace gonio::api {

/// Rounded to 1e-9 of its unit: 3 * 0.1 is not 0.3, and a nano-degree is far below what any axis resolves.
[[nodiscard]] double without_creep(double value);

/// A list of numbers, or {from, to, step} with both ends; each once. After an error, recorded in the reader, anything.
[[nodiscard]] std::vector<double> read_values(TomlReader& table, std::string_view key, NumberRange range);

/// Records an error when a value stands in the list twice.
void refuse_repetition(TomlReader& table, std::string_view key, const std::vector<double>& values,
                       std::string_view unit);

}  // namespace gonio::api
