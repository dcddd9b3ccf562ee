#include "calibration/point_flags.h"

#include <array>

namespace gonio::calibration {
namespace {

constexpr std::array<FlagWord, 13> kFlagWords{{
    {PointFlag::NearZero, "near-zero", "not told from zero: |f| is at most U; the sign is kept"},
    {PointFlag::DarkExtrapolated, "dark-extrapolated", "no dark on one side of a reading: the nearest one, widened"},
    {PointFlag::FewNeighbours, "few-neighbours", "no other point on a line of angles: the slope there is guessed"},
    {PointFlag::BorrowedReference, "borrowed-reference", "the reference was read for another point of this geometry"},
    {PointFlag::UncertainDivisor, "uncertain-divisor", "the reference's own reading is uncertain by more than 5 %"},
    {PointFlag::Drifted, "drifted", "read between two visits of the standard beyond the plan's drift limit"},
    {PointFlag::InstrumentLimited, "instrument-limited", "f_r bends within the cones of source and detector"},
    {PointFlag::MonteCarlo, "monte-carlo", "u and U by Monte Carlo (JCGM 101), where the formula does not hold"},
    {PointFlag::FewRepeats, "few-repeats", "fewer than 10 effective degrees of freedom: k is Student's"},
    {PointFlag::Mixed, "mixed", "neither lit spot nor field of view holds the other: by the overlap of both"},
    {PointFlag::ReferenceExtrapolated, "reference-extrapolated",
     "up to 0.1 deg beyond the shape table, whose edge is held"},
    {PointFlag::Blocked, "blocked", "one arm's head stands in the other's light"},
    {PointFlag::Saturated, "saturated", "some exposures of the reading were saturated and left out"},
}};

constexpr bool bits_ascend() {
  for (std::size_t n = 0; n < kFlagWords.size(); ++n) {
    if (static_cast<std::uint32_t>(kFlagWords[n].flag) != 1U << n) return false;
  }
  return true;
}
static_assert(bits_ascend());

}  // namespace

std::span<const FlagWord> all_flag_words() {
  return kFlagWords;
}

std::string flag_words(std::uint32_t flags) {
  std::string words;
  for (const FlagWord& word : kFlagWords) {
    if (has(flags, word.flag)) words += (words.empty() ? "" : " ") + std::string(word.name);
  }
  return words;
}

}  // namespace gonio::calibration
