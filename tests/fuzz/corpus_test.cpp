// What the fuzzers have kept, through the same entries, in every build: each input as it is, then neighbours of it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/mutation.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

using Input = std::vector<std::uint8_t>;

constexpr std::uint64_t kSeed = 20261122;
constexpr std::size_t kNeighbours = 1000;  // of a target, over all its inputs
constexpr std::size_t kLongest = 16384;    // of a neighbour: longer ones only take longer

struct Kept {
  std::string name;
  Input bytes;
};

std::vector<Kept> corpus_of(std::string_view target) {
  std::vector<Kept> corpus;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(GONIO_CORPUS_DIR) / target)) {
    std::ifstream in(entry.path(), std::ios::binary);
    corpus.push_back({entry.path().filename().string(), Input(std::istreambuf_iterator<char>(in), {})});
  }
  std::ranges::sort(corpus, {}, &Kept::name);  // the same neighbours on every machine
  return corpus;
}

std::string hex(const Input& bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text.push_back(kDigits[byte >> 4U]);
    text.push_back(kDigits[byte & 0xFU]);
  }
  return text;
}

void run(const Target& target, const Input& input, const std::string& name) {
  try {
    target.run(input);
  } catch (const BrokenPromise& broken) {
    ADD_FAILURE() << target.name << ", " << name << ": " << broken.what() << "\n" << hex(input);
  }
}

class Corpus : public testing::TestWithParam<Target> {};

TEST_P(Corpus, KeepsItsPromisesOnEveryKeptInput) {
  const auto corpus = corpus_of(GetParam().name);

  ASSERT_FALSE(corpus.empty());
  for (const Kept& kept : corpus) run(GetParam(), kept.bytes, kept.name);
}

TEST_P(Corpus, KeepsItsPromisesOnNeighboursOfThem) {
  const auto corpus = corpus_of(GetParam().name);
  std::mt19937_64 chance(kSeed);
  SCOPED_TRACE("seed " + std::to_string(kSeed));

  for (std::size_t k = 0; k < kNeighbours; ++k) {
    const Kept& kept = corpus[k % corpus.size()];
    const Kept& other = corpus[chance() % corpus.size()];
    Input input = mutated(kept.bytes, other.bytes, chance);
    input.resize(std::min(input.size(), kLongest));
    run(GetParam(), input, "neighbour " + std::to_string(k) + " of " + kept.name);
  }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, testing::ValuesIn(kTargets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace gonio::fuzz
