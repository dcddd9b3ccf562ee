#pragma once

#include <filesystem>

namespace gonio::bench {

/// Error against time of rho_dh: every method at every setting on every case, timed in turns. Writes rho_dh.tsv (every
/// measurement) and rho_dh.md (the tables) into `folder`, the tables to stdout too. False when on some case rho_dh is
/// not 100 times faster at 1e-6 than every general quadrature that gets there.
[[nodiscard]] bool measure_rho_dh(const std::filesystem::path& folder);

}  // namespace gonio::bench
