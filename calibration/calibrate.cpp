#include "calibration/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/component_table.h"
#include "calibration/cone_correction.h"
#include "calibration/direction_slopes.h"
#include "calibration/monte_carlo.h"
#include "calibration/parallel_blocks.h"
#include "calibration/point_budget.h"
#include "calibration/point_equation.h"
#include "calibration/reading_pairs.h"
#include "calibration/scan_histories.h"
#include "calibration/spectral_term.h"
#include "calibration/term_list.h"

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
  std::vector<PairedPoint> pairs;
  std::vector<Origin> origins;     ///< as many
  std::vector<SlopePoint> places;  ///< as many, until they are joined
  std::vector<RefusedPoint> refused;
  double frame_chi2 = 0.0;
  double frame_dof = 0.0;
};

/// The scan on its way. Blocks are never joined: a pair of readings is some kilobyte.
struct Draft {
  std::vector<DraftBlock> blocks;
  std::vector<SlopePoint> places;  ///< of all blocks
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
  draft.frame_chi2 += pair.sample.frame_chi2 + pair.reference.frame_chi2;
  draft.frame_dof += pair.sample.frame_dof + pair.reference.frame_dof;
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
  return draft;
}

Draft draft_scan(const Workshop& shop) {
  const std::vector<ReadingPair> pairs = pair_readings(shop.scan);
  Draft draft;
  draft.blocks.resize(blocks_of(pairs.size()));
  for_blocks(draft.blocks.size(), shop.options.threads, [&](std::size_t block) {
    const std::size_t first = block * kPointsInBlock;
    draft.blocks[block] = draft_block(pairs, first, std::min(pairs.size(), first + kPointsInBlock), shop);
  });
  draft.places.reserve(pairs.size());
  for (DraftBlock& block : draft.blocks) {
    block.first = draft.places.size();
    draft.places.insert(draft.places.end(), block.places.begin(), block.places.end());
    block.places = {};
  }
  return draft;
}

std::vector<SpectralSlope> spectral_slopes_of(const Draft& draft, const InstrumentModel& instrument) {
  if (!instrument.spectral) return std::vector<SpectralSlope>(draft.places.size());
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
                       const ConeCorrection& cones, bool borrowed) {
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
  set(PointFlag::UncertainDivisor,
      std::hypot(pair.reference.u_noise, pair.reference.u_monitor) > kLinearUpTo * pair.reference.q);
  set(PointFlag::InstrumentLimited, cones.is_limited);
  set(PointFlag::MonteCarlo, budget.method == BudgetMethod::MonteCarlo);
  set(PointFlag::FewRepeats, budget.degrees_of_freedom < kFewRepeats);
  return flags;
}

/// What is known of a scan's neighbourhoods once all of its points have a value.
struct Neighbourhoods {
  std::vector<DirectionSlopes> slopes;
  std::vector<SpectralSlope> spectral;
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
  const DirectionSlopes& slopes = around.slopes[n];
  const ConeCorrection cones = cone_correction(pair, slopes, shop.instrument, shop.standard);
  if (!shop.options.left_out.cones) pair.value -= cones.bias;
  point.value = per_steradian(pair.value);
  terms.clear();
  shop.rules.add_terms(pair, slopes, cones, around.spectral[n], terms);
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
  point.flags = flags_of(pair, point.budget, slopes, cones, origin.is_borrowed);
  return point;
}

// From a block's numbers of the components to the scan's.
void renumber(Budget& budget, const std::vector<std::uint32_t>& numbers) {
  for (auto* terms : {&budget.random, &budget.shared}) {
    for (BudgetTerm& term : *terms) term.component = numbers[term.component];
    std::ranges::sort(*terms, {}, &BudgetTerm::component);
  }
}

std::vector<Component> finish_points(const Neighbourhoods& around, const Workshop& shop, Draft& draft,
                                     std::vector<CalibratedPoint>& points) {
  points.resize(draft.places.size());
  std::vector<ComponentTable> tables(draft.blocks.size());
  for_blocks(tables.size(), shop.options.threads, [&](std::size_t number) {
    DraftBlock& block = draft.blocks[number];
    TermList terms(tables[number]);
    for (std::size_t k = 0; k < block.pairs.size(); ++k) {
      points[block.first + k] = finish_point(block.first + k, around, shop, block.origins[k], block.pairs[k], terms);
    }
    block.pairs = {};
  });
  if (tables.size() == 1) return tables.front().components();
  ComponentTable all;
  std::vector<std::vector<std::uint32_t>> numbers;
  for (const ComponentTable& table : tables) numbers.push_back(all.join(table));
  for_blocks(tables.size(), shop.options.threads, [&](std::size_t number) {
    const DraftBlock& block = draft.blocks[number];
    for (std::size_t k = 0; k < block.origins.size(); ++k) renumber(points[block.first + k].budget, numbers[number]);
  });
  return all.components();
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

ScanSummary summarise(const std::vector<CalibratedPoint>& points, const Draft& draft) {
  ScanSummary summary{.points = points.size()};
  std::vector<double> absolute;
  std::vector<double> relative;
  absolute.reserve(points.size());
  relative.reserve(points.size());
  for (const CalibratedPoint& point : points) {
    absolute.push_back(point.budget.expanded.si());
    if (has(point.flags, PointFlag::NearZero))
      ++summary.near_zero;
    else
      relative.push_back(point.budget.expanded.si() / std::abs(point.value.si()));
  }
  double chi2 = 0.0;
  double dof = 0.0;
  for (const DraftBlock& block : draft.blocks) {
    summary.refused += block.refused.size();
    chi2 += block.frame_chi2;
    dof += block.frame_dof;
  }
  summary.worst_relative_expanded = relative.empty() ? 0.0 : std::ranges::max(relative);
  summary.median_relative_expanded = median(relative);
  summary.median_expanded = per_steradian(median(absolute));
  summary.frame_chi2_per_dof = dof > 0.0 ? chi2 / dof : 0.0;
  return summary;
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
  const Workshop shop(scan, instrument, standard, options);
  Draft draft = draft_scan(shop);
  const Neighbourhoods around{.slopes = direction_slopes(draft.places, scan.isotropic, options.threads),
                              .spectral = spectral_slopes_of(draft, instrument)};
  CalibratedScan calibrated;
  calibrated.components = finish_points(around, shop, draft, calibrated.points);
  calibrated.summary = summarise(calibrated.points, draft);
  for (DraftBlock& block : draft.blocks) {
    std::ranges::move(block.refused, std::back_inserter(calibrated.refused));
  }
  return calibrated;
}

}  // namespace gonio::calibration
