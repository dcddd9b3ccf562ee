#include "tests/fuzz/mutation.h"

#include <array>

namespace gonio::fuzz {
namespace {

using Input = std::vector<std::uint8_t>;

constexpr std::array<std::uint8_t, 12> kEdges{0x00, 0x01, 0x7F, 0x80, 0xFE, 0xFF, '-', '"', '[', '\n', '9', 'e'};
constexpr std::size_t kMostChanges = 4;
constexpr std::size_t kLongestRun = 32;

std::size_t below(std::mt19937_64& chance, std::size_t count) {
  return static_cast<std::size_t>(chance() % count);
}

Input::iterator somewhere(Input& input, std::mt19937_64& chance) {
  return input.begin() + static_cast<std::ptrdiff_t>(below(chance, input.size() + 1));
}

// A stretch of the input, as offsets.
std::pair<std::size_t, std::size_t> stretch(const Input& input, std::mt19937_64& chance) {
  const std::size_t from = below(chance, input.size());
  return {from, std::min(input.size(), from + 1 + below(chance, kLongestRun))};
}

void change(Input& input, Bytes other, std::mt19937_64& chance) {
  if (input.empty()) input.push_back(static_cast<std::uint8_t>(chance()));
  const auto [from, to] = stretch(input, chance);
  const auto first = input.begin() + static_cast<std::ptrdiff_t>(from);
  const auto last = input.begin() + static_cast<std::ptrdiff_t>(to);
  switch (below(chance, 6)) {
    case 0:
      *first = static_cast<std::uint8_t>(chance());
      break;
    case 1:
      *first = kEdges[below(chance, kEdges.size())];
      break;
    case 2:
      input.insert(somewhere(input, chance), kEdges[below(chance, kEdges.size())]);
      break;
    case 3:
      input.erase(first, last);
      break;
    case 4: {
      const Input copy(first, last);
      input.insert(somewhere(input, chance), copy.begin(), copy.end());
      break;
    }
    default: {
      if (other.empty()) break;
      input.erase(first, input.end());
      const Bytes tail = other.subspan(below(chance, other.size()));
      input.insert(input.end(), tail.begin(), tail.end());
    }
  }
}

}  // namespace

Input mutated(Bytes input, Bytes other, std::mt19937_64& chance) {
  Input result(input.begin(), input.end());
  const std::size_t changes = 1 + below(chance, kMostChanges);
  for (std::size_t k = 0; k < changes; ++k) change(result, other, chance);
  return result;
}

}  // namespace gonio::fuzz
