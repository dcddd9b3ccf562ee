#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::reflectance {

/// One quantity and what four books call it (the comparison of appendix A in Mobley 2005, with the angles of
/// direction/). A name is empty where the book has none for it.
struct NotationRow {
  std::string_view quantity;
  std::string_view unit;             ///< "" where there is none
  std::string_view notes;            ///< Mobley (2005), and this library
  std::string_view hapke;            ///< Hapke (1993)
  std::string_view nbs160;           ///< Nicodemus et al. (1977)
  std::string_view light_and_water;  ///< Mobley (1994)
};

enum class Notation : std::uint8_t { Notes, Hapke, Nbs160, LightAndWater };

[[nodiscard]] std::span<const NotationRow> notation_rows();

/// What a book means by a symbol, such as "g" in Hapke: the phase angle. Null when it has no such symbol. Symbols are
/// spelled as in the table: "theta_i", "f_r".
[[nodiscard]] const NotationRow* find_symbol(Notation book, std::string_view symbol);

/// Symbols that two of the books use for different quantities, in alphabetical order.
[[nodiscard]] std::vector<std::string_view> clashing_symbols();

/// The rows as a table in Markdown, for NOTATION.md.
[[nodiscard]] std::string notation_table();

}  // namespace gonio::reflectance
