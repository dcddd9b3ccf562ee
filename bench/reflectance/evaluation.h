#pragma once

#include <filesystem>

namespace gonio::bench {

/// What one value of f_r costs on each surface: alone, in a batch, in a batch by vector code, whose stated error is
/// held against `eval`. Writes evaluation.tsv and evaluation.md into `folder`, the table to stdout too. False when a
/// fast value is farther off than stated.
[[nodiscard]] bool measure_evaluation(const std::filesystem::path& folder);

}  // namespace gonio::bench
