#include "calibration/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/large_array.h"
#include "calibration/component_table.h"
#include "calibration/cone_correction.h"
#include "calibration/direction_slopes.h"
#include "calibration/monte_carlo.h"
#include "calibration/parallel_blocks.h"
#include "calibration/point_budget.h"
#include "calibration/point_equation.h"
#include "calibration/reading_pairs.h"
#include "calibration/scan_histories.h"
#include "calibration/scan_tally.h"
#include "calibration/spectral_term.h"
#include "calibration/term_list.h"
#include "calibration/term_store.h"

namespace gonio::calibration {
namespace {

// Part of the result: components are numbered by block, so that no bit depends on who worked on which.
constexpr std::size_t kPointsInBlock = 16384;

std::size_t blocks_of(std::size_t points) {
  return (points + kPointsInBlock - 1) / kPointsInBlock;
}

Error no_reference(const PlannedPoint& point) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = fmt::format("calibrate point {}", point.index),
          .seen = "no reference reading",
          .limit = "one at the same geometry and wavelength"};
}

/// A block of the scan on its way: its points that have a pair of readings.
struct DraftBlock {
  std::size_t first = 0;             ///< of its points, among all with a value
  std::vector<std::size_t> of_plan;  ///< each one's number in the plan
  std::vector<PairedPoint> kept;     ///< as many, where they are kept (is_dear)
  std::vector<RefusedPoint> refused;
  ScanTally tally;
};

/// The scan on its way.
struct Draft {
  std::vector<ReadingPair> pairs;  ///< [n]: of the plan's point n
  std::vector<DraftBlock> blocks;
  LargeArray<SlopePoint> places;  ///< of all points with a value
};

/// All that every point of a scan is made with.
struct Workshop {
  const ScanReadings& scan;
  const InstrumentModel& instrument;
  const ReferenceStandard& standard;
  const CalibrationOptions& options;
  ScanHistories histories;
  BudgetRules rules;

  Workshop(const ScanReadings& readings, const InstrumentModel& model, const ReferenceStandard& white,
           const CalibrationOptions& how)
      : scan(readings),
        instrument(model),
        standard(white),
        options(how),
        histories(readings, model, how),
        rules(model, white, histories.has_trap_visits()) {}

  [[nodiscard]] EquationContext equation() const {
    return {.histories = &histories, .instrument = &instrument, .standard = &standard, .left_out = options.left_out};
  }
};

// A pair of readings is some kilobyte: to work it out twice costs less than to carry it through memory, but where its
// terms have names of their own or its area is an integral.
bool is_dear(const Workshop& shop) {
  return shop.scan.reference_mode != ReferenceMode::SameGeometry || shop.instrument.overlap.has_value();
}

SlopePoint place_of(const PlannedPoint& point, const PairedPoint& pair, const InstrumentModel& instrument) {
  return {.planned = point.geometry,
          .reported = pair.sample.geometry,
          .wavelength = point.wavelength,
          .value = per_steradian(pair.value),
          .u_random = scatter(pair, instrument),
          .state = static_cast<std::int32_t>(point.polarisation)};
}

// Readings lie where their memory was found, one by one: those of a point soon to come are called from memory
// meanwhile.
void call_readings(const std::vector<ReadingPair>& pairs, std::size_t n) {
  constexpr std::size_t kReadingsAhead = 8;
  constexpr std::size_t kFramesAhead = 4;  // of readings that have come by then
  constexpr std::size_t kLine = 64;
  if (n + kReadingsAhead >= pairs.size()) return;
  for (const RawReading* reading : {pairs[n + kReadingsAhead].sample, pairs[n + kReadingsAhead].reference}) {
    for (std::size_t at = 0; at < sizeof(RawReading); at += kLine) {
      __builtin_prefetch(reinterpret_cast<const char*>(reading) + at);
    }
  }
  for (const RawReading* reading : {pairs[n + kFramesAhead].sample, pairs[n + kFramesAhead].reference}) {
    if (reading == nullptr) continue;
    for (std::size_t at = 0; at < sizeof(RawFrame); at += kLine) {
      __builtin_prefetch(reinterpret_cast<const char*>(reading->frames.data()) + at);
    }
  }
}

/// Works one block out, as far as it needs no other.
class BlockDrafter {
 public:
  BlockDrafter(const Workshop& shop, const std::vector<ReadingPair>& pairs)
      : shop_(shop), pairs_(pairs), context_(shop.equation()), keeps_(is_dear(shop)) {}

  /// The block's places come to the beginning of `places`, which has room for `last` - `first`.
  DraftBlock draft(std::size_t first, std::size_t last, SlopePoint* places) {
    DraftBlock block;
    block.of_plan.reserve(last - first);
    for (std::size_t n = first; n < last; ++n) {
      call_readings(pairs_, n);
      if (pairs_[n].sample == nullptr) continue;
      auto outcome = equate_one(n);
      if (!outcome) {
        block.refused.push_back({shop_.scan.points[n].index, std::move(outcome).error()});
        continue;
      }
      *places++ = place_of(shop_.scan.points[n], pair_, shop_.instrument);
      block.of_plan.push_back(n);
      block.tally.frame_chi2 += pair_.sample.frame_chi2 + pair_.reference.frame_chi2;
      block.tally.frame_dof += pair_.sample.frame_dof + pair_.reference.frame_dof;
      if (keeps_) block.kept.push_back(pair_);
    }
    block.tally.refused = block.refused.size();
    return block;
  }

 private:
  Result<void> equate_one(std::size_t n) {
    const PlannedPoint& point = shop_.scan.points[n];
    if (pairs_[n].reference == nullptr && shop_.scan.reference_mode == ReferenceMode::SameGeometry) {
      return failure(no_reference(point));
    }
    return equate(point, pairs_[n], context_, pair_);
  }

  const Workshop& shop_;
  const std::vector<ReadingPair>& pairs_;
  EquationContext context_;
  bool keeps_;
  PairedPoint pair_;
};

// Each block has written its places where they belong if no point is missing before them.
void close_gaps(Draft& draft) {
  std::size_t points = 0;
  for (std::size_t b = 0; b < draft.blocks.size(); ++b) {
    DraftBlock& block = draft.blocks[b];
    block.first = points;
    const auto from = draft.places.begin() + static_cast<std::ptrdiff_t>(b * kPointsInBlock);
    const auto to = draft.places.begin() + static_cast<std::ptrdiff_t>(points);
    if (from != to) std::copy(from, from + static_cast<std::ptrdiff_t>(block.of_plan.size()), to);
    points += block.of_plan.size();
  }
  draft.places.resize(points);
}

Draft draft_scan(const Workshop& shop, std::vector<ReadingPair> pairs) {
  Draft draft{.pairs = std::move(pairs)};
  const std::size_t points = draft.pairs.size();
  draft.places.resize(points);
  draft.blocks.resize(blocks_of(points));
  for_blocks(draft.blocks.size(), shop.options.threads, [&](std::size_t block) {
    const std::size_t first = block * kPointsInBlock;
    const std::size_t last = std::min(points, first + kPointsInBlock);
    draft.blocks[block] = BlockDrafter(shop, draft.pairs).draft(first, last, draft.places.data() + first);
  });
  close_gaps(draft);
  return draft;
}

std::vector<SpectralSlope> spectral_slopes_of(const Draft& draft, const Workshop& shop) {
  if (!shop.instrument.spectral) return {};
  std::vector<SpectralPoint> points;
  for (const SlopePoint& place : draft.places) {
    const bool has_standard = shop.scan.reference_mode != ReferenceMode::Absolute;
    const double certificate = has_standard ? shop.standard.reflectance(place.wavelength).value().value : 1.0;
    points.push_back({.planned = place.planned,
                      .wavelength = place.wavelength,
                      .over_certificate = certificate > 0.0 ? place.value.si() / certificate : place.value.si(),
                      .certificate = certificate > 0.0 ? certificate : 1.0});
  }
  return spectral_slopes(points);
}

bool is_extrapolated(const NormalisedReading& reading) {
  return std::ranges::any_of(reading.darks, [](const DarkShare& d) { return d.level.is_extrapolated(); });
}

bool is_drifted(const std::optional<DriftLevel>& drift) {
  return drift && drift->is_large;
}

std::uint32_t flags_of(const PairedPoint& pair, const Budget& budget, const DirectionSlopes& slopes,
                       const ConeCorrection& cones, const TermList& terms, bool borrowed) {
  std::uint32_t flags = 0;
  const auto set = [&](PointFlag flag, bool on) { flags |= on ? static_cast<std::uint32_t>(flag) : 0U; };
  constexpr double kLinearUpTo = 0.05;
  constexpr double kFewRepeats = 10.0;
  set(PointFlag::NearZero, std::abs(pair.value) <= budget.expanded.si());
  set(PointFlag::DarkExtrapolated, is_extrapolated(pair.sample) || is_extrapolated(pair.reference));
  set(PointFlag::FewNeighbours, !std::ranges::all_of(slopes.has_neighbours, std::identity{}));
  set(PointFlag::BorrowedReference, borrowed);
  set(PointFlag::Drifted, is_drifted(pair.sample_drift) || is_drifted(pair.reference_drift) || pair.is_anchor_drifted);
  set(PointFlag::Mixed, pair.is_mixed);
  set(PointFlag::UncertainDivisor, relative_divisor(terms) > kLinearUpTo);
  set(PointFlag::ReferenceExtrapolated, pair.is_beyond_standard);
  set(PointFlag::Blocked, pair.is_blocked);
  set(PointFlag::Saturated, pair.sample.has_saturated || pair.reference.has_saturated);
  set(PointFlag::InstrumentLimited, cones.is_limited);
  set(PointFlag::MonteCarlo, budget.method == BudgetMethod::MonteCarlo);
  set(PointFlag::FewRepeats, budget.degrees_of_freedom < kFewRepeats);
  return flags;
}

/// What is known of a scan's neighbourhoods once all of its points have a value.
struct Neighbourhoods {
  SlopeField slopes;
  std::vector<SpectralSlope> spectral;  ///< empty: the instrument states none
};

/// Makes the points of one block, one after the other.
class BlockFinisher {
 public:
  BlockFinisher(const Workshop& shop, const Neighbourhoods& around, const Draft& draft, const DraftBlock& block,
                ComponentTable& table)
      : shop_(shop), around_(around), draft_(draft), block_(block), context_(shop.equation()), terms_(table) {}

  void finish(std::size_t k, TermStore& store, CalibratedPoint& point) {
    const std::size_t n = block_.first + k;
    call_readings(draft_.pairs, block_.of_plan[k]);
    equate_again(k);
    const DirectionSlopes slopes = around_.slopes.at(n);
    const ConeCorrection cones = cone_correction(pair_, slopes, shop_.instrument, shop_.standard);
    if (!shop_.options.left_out.cones) pair_.value -= cones.bias;
    terms_.clear();
    const SpectralSlope spectral = around_.spectral.empty() ? SpectralSlope{} : around_.spectral[n];
    shop_.rules.add_terms(pair_, slopes, cones, spectral, terms_);
    begin_point(k, point);
    point.budget = budget_of(n, slopes);
    point.flags = flags_of(pair_, point.budget, slopes, cones, terms_, readings(k).is_borrowed);
    store.keep(point.budget);
  }

 private:
  [[nodiscard]] const ReadingPair& readings(std::size_t k) const { return draft_.pairs[block_.of_plan[k]]; }

  void equate_again(std::size_t k) {
    if (!block_.kept.empty()) {
      pair_ = block_.kept[k];
    } else {
      (void)equate(shop_.scan.points[block_.of_plan[k]], readings(k), context_, pair_);  // as it went before
    }
    add_standard_slopes(context_, pair_);
  }

  void begin_point(std::size_t k, CalibratedPoint& point) const {
    point.point_index = shop_.scan.points[block_.of_plan[k]].index;
    point.geometry = pair_.sample.geometry;
    point.wavelength = pair_.wavelength;
    point.value = per_steradian(pair_.value);
    point.sample_reading = readings(k).sample->id;
    point.reference_reading = pair_.reference_id;
  }

  Budget budget_of(std::size_t n, const DirectionSlopes& slopes) {
    Budget budget = terms_.budget();
    const MonteCarloUse use = shop_.options.monte_carlo;
    const Nonlinearity bent = shop_.rules.nonlinearity(pair_, slopes);
    const bool is_needed =
        use == MonteCarloUse::Always || (use == MonteCarloUse::WhereNeeded && needs_monte_carlo(budget, terms_, bent));
    if (is_needed) {
      const std::uint64_t stream =
          shop_.options.seed * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(n) * 0x2545F491ULL;
      propagate_by_monte_carlo(pair_.value, terms_, bent, stream, budget);
    }
    return budget;
  }

  const Workshop& shop_;
  const Neighbourhoods& around_;
  const Draft& draft_;
  const DraftBlock& block_;
  EquationContext context_;
  TermList terms_;
  PairedPoint pair_;
};

void finish_block(const Neighbourhoods& around, const Workshop& shop, const Draft& draft, DraftBlock& block,
                  ComponentTable& table, TermStore& store, std::span<CalibratedPoint> points) {
  store = TermStore(points.size());
  BlockFinisher finisher(shop, around, draft, block, table);
  for (std::size_t k = 0; k < points.size(); ++k) {
    finisher.finish(k, store, points[k]);
    block.tally.add(points[k]);
  }
  block.kept = {};
}

// One table of all blocks' components; the terms count in it.
std::vector<Component> join_components(const std::vector<ComponentTable>& tables, std::vector<TermStore>& terms,
                                       int threads) {
  ComponentTable all;
  std::vector<std::vector<std::uint32_t>> numbers;
  for (const ComponentTable& table : tables) numbers.push_back(all.join(table));
  for_blocks(tables.size(), threads, [&](std::size_t block) { terms[block].renumber(numbers[block]); });
  return all.components();
}

void finish_points(const Neighbourhoods& around, const Workshop& shop, Draft& draft, CalibratedScan& scan) {
  scan.points.resize(draft.places.size());
  const std::span<CalibratedPoint> points = scan.points;
  const auto store = std::make_shared<std::vector<TermStore>>(draft.blocks.size());
  std::vector<ComponentTable> tables(draft.blocks.size());
  for_blocks(tables.size(), shop.options.threads, [&](std::size_t number) {
    DraftBlock& block = draft.blocks[number];
    finish_block(around, shop, draft, block, tables[number], (*store)[number],
                 points.subspan(block.first, block.of_plan.size()));
  });
  scan.components = join_components(tables, *store, shop.options.threads);
  scan.terms = store;
}

}  // namespace

std::string_view flag_name(PointFlag flag) {
  switch (flag) {
    case PointFlag::NearZero:
      return "near-zero";
    case PointFlag::DarkExtrapolated:
      return "dark-extrapolated";
    case PointFlag::FewNeighbours:
      return "few-neighbours";
    case PointFlag::BorrowedReference:
      return "borrowed-reference";
    case PointFlag::UncertainDivisor:
      return "uncertain-divisor";
    case PointFlag::Drifted:
      return "drifted";
    case PointFlag::InstrumentLimited:
      return "instrument-limited";
    case PointFlag::MonteCarlo:
      return "monte-carlo";
    case PointFlag::FewRepeats:
      return "few-repeats";
    case PointFlag::Mixed:
      return "mixed";
    case PointFlag::ReferenceExtrapolated:
      return "reference-extrapolated";
    case PointFlag::Blocked:
      return "blocked";
    case PointFlag::Saturated:
      return "saturated";
  }
  return "";
}

Result<CalibratedScan> calibrate(const ScanReadings& scan, const InstrumentModel& instrument,
                                 const ReferenceStandard& standard, UtcTime measured_on,
                                 const CalibrationOptions& options) {
  GONIO_TRY(standard.check_date(measured_on));
  std::vector<ReadingPair> pairs;
  std::optional<Workshop> shop;
  for_blocks(2, options.threads, [&](std::size_t which) {
    if (which == 0) {
      pairs = pair_readings(scan);
    } else {
      shop.emplace(scan, instrument, standard, options);
    }
  });
  Draft draft = draft_scan(*shop, std::move(pairs));
  const Neighbourhoods around{.slopes = SlopeField(draft.places, scan.isotropic, options.threads),
                              .spectral = spectral_slopes_of(draft, *shop)};
  CalibratedScan calibrated;
  finish_points(around, *shop, draft, calibrated);
  std::vector<ScanTally> tallies;
  for (DraftBlock& block : draft.blocks) {
    tallies.push_back(std::move(block.tally));
    std::ranges::move(block.refused, std::back_inserter(calibrated.refused));
  }
  calibrated.summary = summary_of(tallies, options.threads);
  return calibrated;
}

}  // namespace gonio::calibration
