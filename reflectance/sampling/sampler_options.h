#pragma once

#include <cstddef>
#include <cstdint>

namespace gonio::reflectance {

/// What a tabulated density is used for.
enum class TableUse : std::uint8_t {
  Unbiased,  ///< each weight makes good what the table is off by: one evaluation of the BRDF a draw
  Fast,      ///< all weights alike: no evaluation, and an error that is told
};

/// What becomes of a BRDF with negative values, as noise gives a measured one.
enum class NegativeValues : std::uint8_t {
  Refuse,  ///< no sampler is made
  Signed,  ///< |f| is drawn from and the weight takes its sign; only Unbiased
};

struct SamplerOptions {
  TableUse use = TableUse::Unbiased;
  /// Of a table: the share of draws that it may misplace (total variation). Fast refuses a surface for which it is not
  /// reached; Unbiased does its best, for there it costs no more than variance. Above 0.
  double accuracy = 2e-3;
  std::size_t most_cells = 65536;  ///< 72 bytes each; 512 to 2^22
  NegativeValues negative_values = NegativeValues::Refuse;
};

}  // namespace gonio::reflectance
