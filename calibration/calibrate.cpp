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
constexpr std::size_t kPointsInBlock = 4096;

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

/// Where a point comes from.
struct Origin {
  std::int32_t point_index = 0;
  std::int64_t sample_reading = 0;
  bool is_borrowed = false;
};

/// A block of the scan on its way: points that have a pair of readings.
struct DraftBlock {
  std::size_t first = 0;  ///< of its points, among all with a value
  LargeArray<PairedPoint> pairs;
  std::vector<Origin> origins;    ///< as many
  LargeArray<SlopePoint> places;  ///< as many, until they are joined
  std::vector<RefusedPoint> refused;
  ScanTally tally;
};

/// The scan on its way. Blocks are never joined: a pair of readings is some kilobyte.
struct Draft {
  std::vector<DraftBlock> blocks;
  LargeArray<SlopePoint> places;  ///< of all blocks
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

void keep_pair(const PlannedPoint& point, const ReadingPair& readings, PairedPoint&& pair, const Workshop& shop,
               DraftBlock& draft) {
  draft.origins.push_back(
      {.point_index = point.index, .sample_reading = readings.sample->id, .is_borrowed = readings.is_borrowed});
  draft.places.push_back({.planned = point.geometry,
                          .reported = pair.sample.geometry,
                          .wavelength = point.wavelength,
                          .value = per_steradian(pair.value),
                          .u_random = scatter(pair, shop.instrument),
                          .state = static_cast<std::int32_t>(point.polarisation)});
  draft.tally.frame_chi2 += pair.sample.frame_chi2 + pair.reference.frame_chi2;
  draft.tally.frame_dof += pair.sample.frame_dof + pair.reference.frame_dof;
  draft.pairs.push_back(std::move(pair));
}

DraftBlock draft_block(const std::vector<ReadingPair>& pairs, std::size_t first, std::size_t last,
                       const Workshop& shop) {
  DraftBlock draft;
  draft.pairs.reserve(last - first);
  draft.origins.reserve(last - first);
  draft.places.reserve(last - first);
  const EquationContext context = shop.equation();
  for (std::size_t n = first; n < last; ++n) {
    const PlannedPoint& point = shop.scan.points[n];
    if (pairs[n].sample == nullptr) continue;
    if (pairs[n].reference == nullptr && shop.scan.reference_mode == ReferenceMode::SameGeometry) {
      draft.refused.push_back({point.index, no_reference(point)});
      continue;
    }
    auto pair = equate(point, pairs[n], context);
    if (pair) {
      keep_pair(point, pairs[n], std::move(*pair), shop, draft);
    } else {
      draft.refused.push_back({point.index, std::move(pair).error()});
    }
  }
  draft.tally.refused = draft.refused.size();
  return draft;
}

void join_places(Draft& draft, int threads) {
  std::size_t points = 0;
  for (DraftBlock& block : draft.blocks) {
    block.first = points;
    points += block.places.size();
  }
  draft.places.resize(points);
  for_blocks(draft.blocks.size(), threads, [&](std::size_t number) {
    DraftBlock& block = draft.blocks[number];
    std::ranges::copy(block.places, draft.places.begin() + static_cast<std::ptrdiff_t>(block.first));
    block.places = {};
  });
}

Draft draft_scan(const Workshop& shop, const std::vector<ReadingPair>& pairs) {
  Draft draft;
  draft.blocks.resize(blocks_of(pairs.size()));
  for_blocks(draft.blocks.size(), shop.options.threads, [&](std::size_t block) {
    const std::size_t first = block * kPointsInBlock;
    draft.blocks[block] = draft_block(pairs, first, std::min(pairs.size(), first + kPointsInBlock), shop);
  });
  join_places(draft, shop.options.threads);
  return draft;
}

std::vector<SpectralSlope> spectral_slopes_of(const Draft& draft, const InstrumentModel& instrument) {
  if (!instrument.spectral) return {};
  std::vector<SpectralPoint> points;
  for (const DraftBlock& block : draft.blocks) {
    for (const PairedPoint& pair : block.pairs) {
      const double certificate = pair.standard.rho.value;
      points.push_back({.planned = draft.places[points.size()].planned,
                        .wavelength = pair.wavelength,
                        .over_certificate = certificate > 0.0 ? pair.value / certificate : pair.value,
                        .certificate = certificate > 0.0 ? certificate : 1.0});
    }
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

CalibratedPoint finish_point(std::size_t n, const Neighbourhoods& around, const Workshop& shop, const Origin& origin,
                             PairedPoint& pair, TermList& terms) {
  CalibratedPoint point{.point_index = origin.point_index,
                        .geometry = pair.sample.geometry,
                        .wavelength = pair.wavelength,
                        .value = {},
                        .budget = {},
                        .sample_reading = origin.sample_reading,
                        .reference_reading = pair.reference_id};
  const DirectionSlopes slopes = around.slopes.at(n);
  const ConeCorrection cones = cone_correction(pair, slopes, shop.instrument, shop.standard);
  if (!shop.options.left_out.cones) pair.value -= cones.bias;
  point.value = per_steradian(pair.value);
  terms.clear();
  const SpectralSlope spectral = around.spectral.empty() ? SpectralSlope{} : around.spectral[n];
  shop.rules.add_terms(pair, slopes, cones, spectral, terms);
  point.budget = terms.budget();
  const MonteCarloUse use = shop.options.monte_carlo;
  const Nonlinearity bent = shop.rules.nonlinearity(pair, slopes);
  const bool is_needed = use == MonteCarloUse::Always ||
                         (use == MonteCarloUse::WhereNeeded && needs_monte_carlo(point.budget, terms, bent));
  if (is_needed) {
    const std::uint64_t stream =
        shop.options.seed * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(n) * 0x2545F491ULL;
    propagate_by_monte_carlo(pair.value, terms, bent, stream, point.budget);
  }
  point.flags = flags_of(pair, point.budget, slopes, cones, terms, origin.is_borrowed);
  return point;
}

void finish_block(const Neighbourhoods& around, const Workshop& shop, DraftBlock& block, ComponentTable& table,
                  TermStore& store, std::span<CalibratedPoint> points) {
  store = TermStore(block.pairs.size());
  TermList terms(table);
  for (std::size_t k = 0; k < block.pairs.size(); ++k) {
    CalibratedPoint& point = points[k];
    point = finish_point(block.first + k, around, shop, block.origins[k], block.pairs[k], terms);
    point.budget.random = store.keep(point.budget.random);
    point.budget.shared = store.keep(point.budget.shared);
    block.tally.add(point);
  }
  block.pairs = {};
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
    finish_block(around, shop, block, tables[number], (*store)[number],
                 points.subspan(block.first, block.pairs.size()));
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
  Draft draft = draft_scan(*shop, pairs);
  const Neighbourhoods around{.slopes = SlopeField(draft.places, scan.isotropic, options.threads),
                              .spectral = spectral_slopes_of(draft, instrument)};
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
