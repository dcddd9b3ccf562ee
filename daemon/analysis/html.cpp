#include "daemon/analysis/html.h"

#include <array>

namespace gonio::analysis {
namespace {

void replace_all(std::string& text, std::string_view what, const std::string& with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string html_table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                       std::size_t numeric) {
  constexpr std::size_t kOfOnePage = 16;  // rows that a printed page surely holds: such a table is not broken
  std::string html = rows.size() <= kOfOnePage ? "<table class=\"whole\"><thead><tr>" : "<table><thead><tr>";
  for (std::size_t n = 0; n < header.size(); ++n) {
    html += (n >= numeric ? "<th class=\"n\">" : "<th>") + header[n] + "</th>";
  }
  html += "</tr></thead><tbody>\n";
  for (const std::vector<std::string>& row : rows) {
    html += "<tr>";
    for (std::size_t n = 0; n < row.size(); ++n)
      html += (n >= numeric ? "<td class=\"n\">" : "<td>") + row[n] + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

std::string html_facts(const std::vector<std::pair<std::string, std::string>>& facts) {
  std::string html = "<table class=\"facts\"><tbody>\n";
  for (const auto& [name, value] : facts) html += "<tr><th>" + name + "</th><td>" + value + "</td></tr>\n";
  return html + "</tbody></table>\n";
}

std::string inline_svg(std::string_view svg, std::string_view prefix) {
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string_view::npos) return {};
  std::string text(svg.substr(begin));
  const std::string p(prefix);
  constexpr std::array kBefore{"id='", "id=\"", "href='#", "href=\"#", "url(#"};
  for (const char* before : kBefore) replace_all(text, before, before + p);
  return text;
}

}  // namespace gonio::analysis
