#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gonio::analysis {

/// A text as HTML shows it.
[[nodiscard]] std::string html_text(std::string_view text);

/// A table; cells are HTML already. `numeric`: columns from this one on are set to the right.
[[nodiscard]] std::string html_table(const std::vector<std::string>& header,
                                     const std::vector<std::vector<std::string>>& rows, std::size_t numeric = 99);

/// Two columns, name and value, both HTML already.
[[nodiscard]] std::string html_facts(const std::vector<std::pair<std::string, std::string>>& facts);

/// gnuplot's SVG as an element of a page: without its XML head, its ids prefixed, so that several stand in one page.
[[nodiscard]] std::string inline_svg(std::string_view svg, std::string_view prefix);

}  // namespace gonio::analysis
