#include "calibration/expected_budget.h"

#include <cmath>
#include <numbers>

#include "calibration/absolute_factor.h"
#include "calibration/component_table.h"
#include "calibration/geometry_factor.h"
#include "calibration/point_budget.h"
#include "calibration/point_equation.h"
#include "calibration/term_list.h"

namespace gonio::calibration {
namespace {

NormalisedReading expected_reading(const Geometry& g, double snr) {
  NormalisedReading reading;
  reading.q = 1.0;
  reading.u_noise = 1.0 / snr;
  reading.geometry = g;
  return reading;
}

// Half way between two visits, each with its noise and its placing.
void expect_visits(PairedPoint& pair, const Expectation& expectation, const InstrumentModel& instrument) {
  const double u = std::hypot(1.0 / expectation.visit_snr, instrument.lamp.u_reproducibility);
  for (const std::int64_t visit : {1, 2}) {
    pair.terms.push_back({.key = {ComponentSource::VisitNoise, visit},
                          .name = "visits of the standard",
                          .u = u,
                          .unit = "1",
                          .owner = {},
                          .per_sd = -0.5 * u});
  }
}

Result<void> expect_standard(PairedPoint& pair, const Expectation& expectation, const InstrumentModel& instrument,
                             const ReferenceStandard& standard) {
  const bool is_anchored = expectation.mode == ReferenceMode::Anchor;
  pair.reference = expected_reading(is_anchored ? expectation.anchor : pair.sample.geometry, expectation.snr);
  pair.reference.at = pair.sample.at + expectation.apart;
  GONIO_TRY(standard.check_reach(pair.wavelength, pair.reference.geometry));
  pair.standard.rho = standard.reflectance(pair.wavelength).value();
  pair.standard.shape = standard.shape(pair.reference.geometry, pair.wavelength);
  GeometryRatio ratio = geometry_ratio(pair.sample.geometry, pair.reference.geometry, instrument);
  pair.sample_log_slope = ratio.sample_slope;
  pair.reference_log_slope = ratio.reference_slope;
  pair.is_mixed = ratio.is_mixed;
  pair.terms = std::move(ratio.terms);
  if (is_anchored) expect_visits(pair, expectation, instrument);
  return {};
}

Result<void> expect_beam(PairedPoint& pair, const InstrumentModel& instrument) {
  auto ratio = absolute_ratio(pair.sample.geometry, pair.wavelength, instrument);
  if (!ratio) return failure(std::move(ratio).error());
  pair.reference.q = 1.0;
  pair.standard.rho.value = 1.0;
  pair.sample_log_slope = ratio->sample_slope;
  pair.is_mixed = ratio->is_mixed;
  pair.terms = std::move(ratio->terms);
  return {};
}

std::string largest(const Budget& budget, const ComponentTable& table) {
  std::optional<BudgetTerm> most;
  for (const auto* terms : {&budget.random, &budget.shared}) {
    for (const BudgetTerm& term : *terms) {
      if (!most || std::abs(term.per_sd.si()) > std::abs(most->per_sd.si())) most = term;
    }
  }
  return most ? table.components()[most->component].name : std::string();
}

}  // namespace

Result<ExpectedBudget> expected_budget(const Geometry& g, Wavelength wavelength, const Expectation& expectation,
                                       const InstrumentModel& instrument, const ReferenceStandard& standard) {
  PairedPoint pair{.mode = expectation.mode, .sample = expected_reading(g, expectation.snr), .wavelength = wavelength};
  if (expectation.mode == ReferenceMode::Absolute) {
    GONIO_TRY(expect_beam(pair, instrument));
  } else {
    GONIO_TRY(expect_standard(pair, expectation, instrument, standard));
  }
  pair.value = std::numbers::inv_pi;
  pair.dvalue_dq = pair.value;
  pair.stray = std::numbers::inv_pi / std::cos(g.theta_i.si());
  ComponentTable table;
  TermList terms(table);
  constexpr bool kNoTrap = false;
  const BudgetRules rules(instrument, standard, kNoTrap);
  rules.add_terms(pair, DirectionSlopes{}, ConeCorrection{}, SpectralSlope{}, terms);
  const Budget budget = terms.budget();
  return ExpectedBudget{
      .relative_u = budget.expanded.si() / pair.value, .dominant = largest(budget, table), .is_mixed = pair.is_mixed};
}

}  // namespace gonio::calibration
