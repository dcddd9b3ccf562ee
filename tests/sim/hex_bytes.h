#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gonio::sim::test {

/// "00 0a ff" as bytes; spaces may stand anywhere between two.
[[nodiscard]] inline std::vector<std::uint8_t> bytes(const std::string& hex) {
  std::vector<std::uint8_t> out;
  std::string digits;
  for (const char c : hex) {
    if (c == ' ') continue;
    digits.push_back(c);
    if (digits.size() < 2) continue;
    out.push_back(static_cast<std::uint8_t>(std::stoi(digits, nullptr, 16)));
    digits.clear();
  }
  return out;
}

}  // namespace gonio::sim::test
