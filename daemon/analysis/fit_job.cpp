#include "daemon/analysis/fit_job.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "daemon/analysis/model_text.h"
#include "daemon/analysis/plot_deviations.h"
#include "reflectance/fit/fit_scan.h"
#include "reflectance/fit/rank_fits.h"
#include "reflectance/fit/scene_text.h"
#include "reflectance/light/overcast_sky.h"
#include "reflectance/measured/scan_quantities.h"

namespace gonio::analysis {
namespace {

using api::AnalysisFact;
using fit::FitResult;
using reflectance::Direction;
using reflectance::MeasuredPoint;
using reflectance::MeasuredScan;

constexpr const char* kUsualModels = "lambertian, minnaert, rpv, lambertian + ggx";
constexpr std::size_t kMostIncidences = 6;

bool has_uncertainties(const MeasuredScan& scan) {
  return std::ranges::all_of(scan.points,
                             [](const MeasuredPoint& p) { return p.is_flagged || p.u_random > per_steradian(0.0); });
}

std::vector<std::string> names_between_commas(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    std::string name = text.substr(at, end - at);
    name.erase(0, name.find_first_not_of(' '));
    if (const std::size_t last = name.find_last_not_of(' '); last != std::string::npos) name.erase(last + 1);
    if (!name.empty()) names.push_back(std::move(name));
    at = end + 1;
  }
  return names;
}

struct RankedFits {
  std::vector<FitResult> fits;
  std::vector<fit::RankedFit> ranks;  ///< best first
  [[nodiscard]] const FitResult& best() const { return fits[ranks.front().fit]; }
};

Result<RankedFits> fitted(const MeasuredScan& scan, const std::string& wanted) {
  std::vector<fit::FitModel> models;
  for (const std::string& name : names_between_commas(wanted.empty() ? kUsualModels : wanted)) {
    Result<fit::FitModel> model = fit::FitModel::make(name);
    if (!model) return failure(model.error());
    models.push_back(std::move(*model));
  }
  const fit::FitOptions options{.weights = has_uncertainties(scan) ? fit::FitWeights::Stated : fit::FitWeights::Even};
  Result<std::vector<FitResult>> fits = fit::fit_models(scan, models, options);
  if (!fits) return failure(fits.error());
  Result<std::vector<fit::RankedFit>> ranks = fit::rank_fits(*fits);
  if (!ranks) return failure(ranks.error());
  return RankedFits{.fits = std::move(*fits), .ranks = std::move(*ranks)};
}

std::string parameter_note(const fit::FittedParameter& p) {
  if (p.is_fixed) return "fixed";
  if (!p.is_determined) return "not determined by these readings: known no better than its bounds";
  return p.is_at_bound ? fmt::format("at its bound, {:.4g} to {:.4g}: U says little", p.least, p.most) : "";
}

std::vector<AnalysisFact> fit_facts(const FitResult& fit) {
  std::vector<AnalysisFact> facts;
  for (const fit::FittedParameter& p : fit.parameters) {
    AnalysisFact fact{.name = p.name, .value = p.value, .unit = "1", .note = parameter_note(p)};
    if (!p.is_fixed) fact.expanded_u = p.U;
    facts.push_back(std::move(fact));
  }
  facts.push_back({.name = "chi-square",
                   .value = fit.chi2,
                   .unit = "1",
                   .note = fmt::format("{} degrees of freedom", fit.degrees_of_freedom) +
                           (fit.p_value ? fmt::format(", p = {:.3g}", *fit.p_value) : ", all readings weighed alike")});
  facts.push_back({.name = "RMS of reading - fit", .value = fit.rms_difference, .unit = "sr^-1", .note = ""});
  for (std::size_t a = 0; a < fit.free_names.size(); ++a) {
    for (std::size_t b = a + 1; b < fit.free_names.size(); ++b) {
      facts.push_back({.name = fmt::format("correlation {}, {}", fit.free_names[a], fit.free_names[b]),
                       .value = fit.correlation[a * fit.free_names.size() + b],
                       .unit = "1",
                       .note = ""});
    }
  }
  return facts;
}

std::vector<std::string> rank_notes(const RankedFits& fits) {
  std::vector<std::string> notes;
  for (const fit::RankedFit& rank : fits.ranks) {
    const FitResult& fit = fits.fits[rank.fit];
    notes.push_back(
        fmt::format("{}: AICc {:.4g} above the best, Akaike weight {:.3g}, chi-square/dof {:.3g}, {} of {} starts "
                    "agree",
                    rank.model, rank.delta, rank.weight,
                    fit.chi2 / static_cast<double>(std::max<std::size_t>(1, fit.degrees_of_freedom)),
                    fit.agreeing_starts, fit.starts));
  }
  if (fits.best().p_value && !fits.best().fits())
    notes.push_back("none of them fits: U of its numbers is what it would be if the best one did");
  for (const std::string& name : fits.best().undetermined()) {
    notes.push_back("the readings do not determine " + name);
  }
  for (const fit::SharedShift& shift : fits.best().shifts) {
    constexpr double kTooFar = 3.0;
    if (std::abs(shift.standard_deviations) < kTooFar) break;
    notes.push_back(
        fmt::format("for this fit to hold, \"{}\" would have to be off by {:.2g} of its standard deviations",
                    shift.component, shift.standard_deviations));
  }
  return notes;
}

AnalysisFact quantity_fact(const reflectance::ScanQuantity& q, const std::string& where) {
  return {.name = q.name + where,
          .value = q.value,
          .expanded_u = q.expanded,
          .unit = q.unit,
          .note = fmt::format(
              "k {:.3g}; u: random {:.2g}, shared {:.2g}, interpolation {:.2g}, modelled {:.2g}; {:.2g} % of it "
              "modelled",
              q.k, q.u_random, q.u_shared, q.u_interpolation, q.u_modelled, 100.0 * q.modelled_share)};
}

// Nominal incidences: encoders scatter by less than 0.5 deg.
std::vector<Direction> incidences_of_scan(const MeasuredScan& scan) {
  std::map<std::pair<long, long>, Direction> found;
  for (const MeasuredPoint& p : scan.points) {
    const bool turns = scan.symmetry == reflectance::TableSymmetry::Anisotropic;
    const std::pair key{std::lround(2.0 * in_degrees(p.geometry.theta_i)),
                        turns ? std::lround(2.0 * in_degrees(p.geometry.phi_i)) : 0L};
    const double theta = std::abs(in_degrees(p.geometry.theta_i));
    found.try_emplace(key, Direction::from_angles(degrees(theta), p.geometry.phi_i));
  }
  std::vector<Direction> all;
  for (const auto& [key, direction] : found) all.push_back(direction);
  if (all.size() <= kMostIncidences) return all;
  std::vector<Direction> shown;
  for (std::size_t k = 0; k < kMostIncidences; ++k) shown.push_back(all[k * (all.size() - 1) / (kMostIncidences - 1)]);
  return shown;
}

template <class Quantity>
void add_quantity(std::vector<AnalysisFact>& facts, std::vector<std::string>& notes, const Result<Quantity>& q,
                  const std::string& where) {
  if (q) {
    facts.push_back(quantity_fact(*q, where));
  } else {
    notes.push_back(describe(q.error()));
  }
}

DeviationsView residuals_of(const FitResult& fit, const std::string& stem) {
  DeviationsView view{.stem = stem,
                      .name = "residuals",
                      .title = "What the fit of " + fit.model.name() + " leaves",
                      .caption =
                          "What the fit leaves of each reading, in units of its own random uncertainty: by phase "
                          "angle, and over the directions of view; within 2 lie 95 % if model and uncertainties "
                          "are true.",
                      .label = "(reading - fit) / u of the reading",
                      .is_in_u = !fit.has_even_weights,
                      .points = {}};
  if (fit.has_even_weights) {
    view.caption = "What the fit leaves of each reading, by phase angle and over the directions of view.";
    view.label = "reading - fit [sr⁻¹]";
  }
  for (const fit::FitResidual& r : fit.residuals) {
    view.points.push_back({.geometry = r.geometry, .value = view.is_in_u ? r.z : in_per_steradian(r.difference)});
  }
  return view;
}

}  // namespace

Result<FitResult> fitted_model(const MeasuredScan& scan, const std::string& model) {
  Result<RankedFits> fits = fitted(scan, model);
  if (!fits) return failure(fits.error());
  return fits->best();
}

Result<Told> fit_told(const MeasuredScan& scan, const std::string& models, const std::string& stem) {
  const Result<RankedFits> fits = fitted(scan, models);
  if (!fits) return failure(fits.error());
  const FitResult& best = fits->best();
  Told told{.facts = fit_facts(best),
            .notes = rank_notes(*fits),
            .texts = {},
            .pictures = {deviations_picture(residuals_of(best, stem))}};
  told.notes.push_back("the fit as a model: \"" + text_of_surface(best.surface) + "\"");
  if (const Result<std::string> scene = fit::scene_sample(best.surface)) told.texts.emplace_back(".toml", *scene);
  return told;
}

Result<Told> quantities_told(const MeasuredScan& scan) {
  Told told;
  std::vector<std::string>& notes = told.notes;
  std::optional<reflectance::CapModel> cap;
  reflectance::InterpolationOptions options;
  if (const Result<RankedFits> fits = fitted(scan, "")) {
    const Result<reflectance::CapModel> made = fit::cap_of(fits->fits);
    if (made) cap = *made;
    options.fitted = fits->best().surface;
    notes.push_back("where nothing was measured stands the fit of " + fits->ranks.front().model);
    if (!fits->best().fits())
      notes.push_back("none of the models that were tried fits: U of what was not measured is larger for it");
  } else {
    notes.push_back("no model for what was not measured: " + describe(fits.error()));
  }
  const auto quantities = reflectance::ScanQuantities::make(scan, options, cap);
  if (!quantities) return failure(quantities.error());
  std::vector<AnalysisFact>& facts = told.facts;
  const std::vector<Direction> incidences = incidences_of_scan(scan);
  for (const Direction& i : incidences) {
    add_quantity(facts, notes, quantities->rho_dh(i), fmt::format("({:.4g} deg)", in_degrees(i.theta())));
  }
  const Direction up;
  add_quantity(facts, notes, quantities->radf_normal_incidence(Direction::from_angles(degrees(45.0), degrees(90.0))),
               "(45 deg aside)");
  if (incidences.size() > 1 || cap) {
    add_quantity(facts, notes, quantities->bond_albedo(), " (light from all directions alike)");
    add_quantity(facts, notes, quantities->rho_hd(up), "(normal)");
    const reflectance::Light overcast = reflectance::Sky(*reflectance::OvercastSky::make(1.0));
    add_quantity(facts, notes, quantities->reflectance_under(overcast), " (overcast sky)");
    add_quantity(facts, notes, quantities->remote_sensing_reflectance(overcast, up), " (overcast sky, nadir)");
  }
  return told;
}

}  // namespace gonio::analysis
