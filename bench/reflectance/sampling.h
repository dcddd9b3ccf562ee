#pragma once

#include <filesystem>

namespace gonio::bench {

/// Directions a second beside their error: the literal C1 to C5, tables, closed forms, cosine with weight, rejection.
/// Writes sampling.tsv and sampling.md into `folder`, the table to stdout too. False when a fast table at its default
/// accuracy makes fewer than 2e7 directions/s, or one misplaces more than it states.
[[nodiscard]] bool measure_sampling(const std::filesystem::path& folder);

}  // namespace gonio::bench
