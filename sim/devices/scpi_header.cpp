#include "sim/devices/scpi_header.h"

#include <algorithm>

namespace gonio::sim {
namespace {

constexpr bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}
constexpr char upper(char c) {
  return is_lower(c) ? static_cast<char>(c - 'a' + 'A') : c;
}

bool same_letters(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, upper, upper);
}

bool is_node(std::string_view pattern, std::string_view node) {
  const auto short_end = std::ranges::find_if(pattern, is_lower);
  const auto short_form = pattern.substr(0, static_cast<std::size_t>(short_end - pattern.begin()));
  return same_letters(pattern, node) || same_letters(short_form, node);
}

// Takes the first node off.
std::string_view take_node(std::string_view& path) {
  const std::size_t colon = path.find(':');
  const std::string_view node = path.substr(0, colon);
  path = colon == std::string_view::npos ? std::string_view() : path.substr(colon + 1);
  return node;
}

bool matches(std::string_view pattern, std::string_view header) {
  if (pattern.empty()) return header.empty();
  std::string_view wanted = take_node(pattern);
  const bool is_optional = wanted.starts_with('[');
  if (is_optional) wanted = wanted.substr(1, wanted.size() - 2);
  if (is_optional && matches(pattern, header)) return true;
  if (header.empty()) return false;
  const std::string_view node = take_node(header);
  return is_node(wanted, node) && matches(pattern, header);
}

}  // namespace

bool is_header(std::string_view pattern, std::string_view header) {
  const bool is_query = pattern.ends_with('?');
  if (header.empty() || is_query != header.ends_with('?')) return false;
  if (is_query) {
    pattern.remove_suffix(1);
    header.remove_suffix(1);
  }
  if (header.starts_with(':')) header.remove_prefix(1);
  return matches(pattern, header);
}

}  // namespace gonio::sim
