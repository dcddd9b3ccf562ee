#include "calibration/point_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calibration/covariance_factor.h"
#include "calibration/history_terms.h"
#include "calibration/mounting_term.h"
#include "calibration/polarisation_term.h"
#include "calibration/root_sum.h"

namespace gonio::calibration {
namespace {

constexpr std::array<std::string_view, kDirectionAxes> kAxisNames = {"theta_i", "theta_r", "phi_r"};

// phi_r - phi_i is made of two axes, each of which stops anew at every move.
double moves_of(std::size_t axis) {
  return axis == 2 ? 2.0 : 1.0;
}

}  // namespace

/// Collects the terms of one point.
class PointTerms {
 public:
  PointTerms(const BudgetRules& rules, const PairedPoint& p, const DirectionSlopes& slopes, TermList& terms)
      : rules_(rules),
        instrument_(rules.instrument_),
        standard_(rules.standard_),
        p_(p),
        slopes_(slopes),
        terms_(terms) {}

  void add() {
    add_sample_scatter();
    if (p_.mode == ReferenceMode::SameGeometry) add_reference_scatter();  // else it stands in the point's own terms
    if (p_.mode != ReferenceMode::Absolute) add_standard();
    add_geometry();
    add_zeros();
    add_detector();
    add_lamp();
    add_history_terms(p_, instrument_, terms_);
    add_linearity_fit();
    add_stray();
  }

 private:
  void add_sample_scatter() {
    const LampModel& lamp = instrument_.lamp;
    terms_.random(ComponentSource::SampleNoise, "noise of the sample reading", 0.0, "sr^-1",
                  p_.dvalue_dq * p_.sample.u_noise, p_.sample.noise_dof);
    terms_.random(ComponentSource::SampleMonitor, "monitor noise of the sample reading", 0.0, "sr^-1",
                  p_.dvalue_dq * p_.sample.u_monitor);
    terms_.random(ComponentSource::SampleReproducibility, "reproducibility of the sample reading",
                  lamp.u_reproducibility, "1", p_.value * lamp.u_reproducibility, lamp.reproducibility_dof);
    terms_.random(ComponentSource::SampleAngles, "angle repeatability of the sample reading",
                  in_degrees(instrument_.angles.u_repeat), "deg", sample_repeat());
  }

  void add_reference_scatter() {
    const double f = p_.value;
    const LampModel& lamp = instrument_.lamp;
    const double noise = p_.reference.u_noise / p_.reference.q;
    const double monitor = p_.reference.u_monitor / p_.reference.q;
    const double placing = lamp.u_reproducibility;
    const double repeat = reference_repeat();
    if (p_.reference_is_shared) {
      const double all = std::sqrt(noise * noise + monitor * monitor + repeat * repeat + placing * placing);
      terms_.shared({ComponentSource::SharedReference, p_.reference_id}, 1.0, "of its own u", -f * all,
                    [&] { return fmt::format("reference reading {}", p_.reference_id); });
      terms_.last_shared_divides(all);
      return;
    }
    terms_.random(ComponentSource::ReferenceNoise, "noise of the reference reading", 0.0, "sr^-1", f * noise,
                  p_.reference.noise_dof);
    terms_.last_random_divides(noise);
    terms_.random(ComponentSource::ReferenceMonitor, "monitor noise of the reference reading", 0.0, "sr^-1",
                  f * monitor);
    terms_.last_random_divides(monitor);
    terms_.random(ComponentSource::ReferenceReproducibility, "reproducibility of the reference reading", placing, "1",
                  f * placing, lamp.reproducibility_dof);
    terms_.random(ComponentSource::ReferenceAngles, "angle repeatability of the reference reading",
                  in_degrees(instrument_.angles.u_repeat), "deg", f * repeat);
  }

  // In q_ref itself the cosine of the radiance mode stays; only in the ratio of two equal zeros does it cancel.
  [[nodiscard]] double reference_repeat() const {
    double sum = 0.0;
    for (std::size_t a = 0; a < kDirectionAxes; ++a) {
      const double slope = p_.standard.slope[a] + p_.reference_log_slope[a];
      sum += moves_of(a) * slope * slope;
    }
    return instrument_.angles.u_repeat.si() * std::sqrt(sum);
  }

  [[nodiscard]] double sample_repeat() const {
    double sum = 0.0;
    for (std::size_t a = 0; a < kDirectionAxes; ++a) {
      const double slope = slopes_.slope[a] + p_.value * p_.sample_log_slope[a];
      sum += moves_of(a) * (slope * slope + slopes_.unresolved[a] * slopes_.unresolved[a]);
    }
    return instrument_.angles.u_repeat.si() * std::sqrt(sum);
  }

  // Entries whose errors are not one: what all have in common, and what each has of its own.
  void add_certificate_errors(const ComponentTraits& traits) {
    const auto errors = standard_.certificate_errors(p_.wavelength);  // its reach has been checked
    for (const CertificateError& error : *errors) {
      const std::int64_t own = error.entry ? static_cast<std::int64_t>(*error.entry) + 1 : 0;
      terms_.shared(
          {ComponentSource::Certificate, own}, error.u, "1", p_.value * error.u,
          [&] { return certificate_error_name(standard_.certificate(), error); }, traits);
    }
  }

  void add_standard() {
    const double f = p_.value;
    const Measured<double>& rho = p_.standard.rho;
    const ComponentTraits traits{.owner = rules_.standard_owner_};
    if (standard_.certificate().correlation == 1.0) {
      terms_.shared(
          {ComponentSource::Certificate}, rho.u / rho.value, "1", f * rho.u / rho.value, [] { return "certificate"; },
          traits);
    } else {
      add_certificate_errors(traits);
    }
    const Geometry& g = p_.reference.geometry;
    const Wavelength wavelength = p_.wavelength;
    const ShapeModePlace at(g);
    for (std::size_t k = 0; k < standard_.modes().size(); ++k) {
      const ShapeMode& mode = standard_.modes()[k];
      terms_.shared(
          {ComponentSource::ShapeMode, static_cast<std::int64_t>(k)}, mode.u, "1",
          f * standard_.mode(k, at, wavelength) * mode.u, [&] { return "shape mode " + mode.name; }, traits);
    }
    terms_.shared(
        {ComponentSource::ShapeIntegral}, standard_.u_integral(), "1", f * standard_.u_integral(),
        [] { return "shape integral"; }, traits);
    terms_.shared({ComponentSource::ShapeInterpolation}, 1.0, "of what curvature suggests",
                  f * standard_.u_interpolation(g, wavelength) / p_.standard.shape,
                  [] { return "shape between the nodes of its table"; },
                  {.owner = rules_.standard_owner_, .is_pattern_known = false});
  }

  void add_geometry() {
    for (const RelativeTerm& term : p_.terms) {
      terms_.shared(term.key, term.u, term.unit, p_.value * term.per_sd, [&] { return term.name; },
                    {.degrees_of_freedom = term.degrees_of_freedom,
                     .owner = term.owner,
                     .is_pattern_known = term.is_pattern_known,
                     .is_of_the_wander = term.is_of_the_wander});
      if (term.divides && term.u != 0.0) terms_.last_shared_divides(-term.per_sd);
    }
    if (p_.u_drift_rest == 0.0) return;
    terms_.random(ComponentSource::DriftRest, "drift from reading to reading", 0.0, "sr^-1", p_.value * p_.u_drift_rest,
                  p_.drift_rest_dof);
    terms_.last_random_divides(p_.u_drift_rest);
  }

  // Of one zero on the ratio: what both readings have of it, cosines included, cancels at equal geometries.
  [[nodiscard]] double zero_slope(std::size_t axis) const {
    return slopes_.slope[axis] - p_.value * p_.standard.slope[axis] +
           p_.value * (p_.sample_log_slope[axis] - p_.reference_log_slope[axis]);
  }

  void add_zeros() {
    const ComponentTraits traits{.owner = rules_.instrument_owner_};
    const std::vector<double>& factor = rules_.zero_factor_;
    for (std::size_t a = 0; a < kDirectionAxes; ++a) {
      const auto axis = static_cast<std::int64_t>(a);
      const double u = rules_.u_zero_[a];
      const double u_deg = in_degrees(radians(u));
      double per_sd = zero_slope(a) * u;
      if (!factor.empty()) {  // the a-th of three independent errors
        per_sd = 0.0;
        for (std::size_t row = 0; row < kDirectionAxes; ++row) per_sd += zero_slope(row) * factor[3 * row + a];
      }
      terms_.shared(
          {ComponentSource::Zero, axis}, u_deg, "deg", per_sd, [&] { return fmt::format("zero {}", kAxisNames[a]); },
          traits);
      terms_.shared({ComponentSource::UnresolvedSlope, axis}, u_deg, "deg", slopes_.unresolved[a] * u,
                    [&] { return fmt::format("zero {} through unresolved slopes", kAxisNames[a]); },
                    {.is_pattern_known = false});
    }
  }

  void add_detector() {
    const DetectorModel& d = instrument_.detector;
    const ComponentTraits traits{.owner = rules_.instrument_owner_};
    const double u_offset = rules_.linearity_factor_.empty() ? d.exposure_offset_s.u : 0.0;
    terms_.shared(
        {ComponentSource::ExposureOffset}, u_offset, "s",
        p_.value * (p_.sample.dlnq_dt0 - p_.reference.dlnq_dt0) * u_offset, [] { return "exposure offset"; }, traits);
    terms_.shared(
        {ComponentSource::Linearity}, d.u_linearity, "1",
        p_.value * (p_.sample.mean_net_dn - p_.reference.mean_net_dn) / d.full_scale_dn * d.u_linearity,
        [] { return "linearity"; }, traits);
  }

  // Coefficients and t0 as the fit of the ladder gave them together, in independent parts.
  void add_linearity_fit() {
    const std::vector<double>& factor = rules_.linearity_factor_;
    if (factor.empty()) return;
    const std::size_t fitted = instrument_.detector.linearity.coefficients.size();
    const std::size_t n = fitted + 1;
    std::vector<double> slope(n);
    for (std::size_t k = 0; k < fitted; ++k) {
      slope[k] = p_.dvalue_dq * p_.sample.dq_dlinearity[k] - p_.value / p_.reference.q * p_.reference.dq_dlinearity[k];
    }
    slope[fitted] = p_.value * (p_.sample.dlnq_dt0 - p_.reference.dlnq_dt0);
    for (std::size_t part = 0; part < n; ++part) {
      double per_sd = 0.0;
      for (std::size_t row = part; row < n; ++row) per_sd += slope[row] * factor[row * n + part];
      terms_.shared({ComponentSource::LinearityFit, static_cast<std::int64_t>(part)}, 1.0, "of the fit", per_sd,
                    [&] { return fmt::format("linearity and exposure offset, part {}", part + 1); },
                    {.owner = rules_.instrument_owner_});
    }
  }

  void add_lamp() {
    const LampModel& lamp = instrument_.lamp;
    if (p_.mode == ReferenceMode::Absolute) {  // the direct beam was read at another time
      terms_.shared({ComponentSource::Lamp, -1}, lamp.u_after_monitor, "1", p_.value * lamp.u_after_monitor,
                    [] { return "lamp after the monitor, since the direct beam"; }, {.is_pattern_known = false});
      return;
    }
    const double apart = in_seconds(p_.reference.at - p_.sample.at) / lamp.correlation_s;
    const double middle =
        0.5 * (in_seconds(p_.reference.at.time_since_epoch()) + in_seconds(p_.sample.at.time_since_epoch()));
    const auto interval = static_cast<std::int64_t>(std::floor(middle / lamp.correlation_s));
    const double u = lamp.u_after_monitor * std::sqrt(-std::expm1(-0.5 * apart * apart));
    terms_.shared({ComponentSource::Lamp, interval}, lamp.u_after_monitor, "1", p_.value * u,
                  [&] {
                    return fmt::format("lamp after the monitor, {:.0f} s",
                                       static_cast<double>(interval) * lamp.correlation_s);
                  },
                  {.is_pattern_known = false});
  }

  // df/db of the stated share b: what both readings have of it, by their brightness; of the light that the targets
  // send back, by their rho_dh over theirs: the standard's is its certificate's, the sample's is not far from pi f.
  void add_stray() {
    const DetectorModel& d = instrument_.detector;
    const double ambient = d.u_ambient_dn_per_s;
    if (!p_.sample.ambient) {
      const double per_sd = p_.dvalue_dq * p_.sample.dq_dambient - p_.value / p_.reference.q * p_.reference.dq_dambient;
      terms_.shared({ComponentSource::Ambient}, ambient, d.power ? "W" : "DN/s", per_sd * ambient,
                    [] { return "ambient light"; });
    }
    if (!instrument_.stray) return;
    const StrayModel& stray = *instrument_.stray;
    const double relative = p_.dvalue_dq > 0.0 ? p_.sample.q / p_.reference.q : 0.0;
    if (!rules_.has_trap_visits_) {
      terms_.shared({ComponentSource::SourceStray}, stray.source_share.u, "of white",
                    (relative * p_.drift_ratio - 1.0) * p_.stray * stray.source_share.u,
                    [] { return "stray light of the source"; }, {.owner = rules_.instrument_owner_});
    }
    const double brightness = std::numbers::pi * p_.standard.rho.value * p_.standard.shape / std::numbers::pi;
    const double both = root_sum(stray.internal_share.value, stray.internal_share.u);
    const bool has_standard = p_.mode != ReferenceMode::Absolute;
    const double reference = has_standard ? p_.value * p_.standard.rho.value / brightness : 0.0;
    terms_.shared({ComponentSource::InternalStray}, both, "of the light that leaves the target",
                  (reference - p_.value) * both, [] { return "stray light within the detector"; },
                  {.owner = rules_.instrument_owner_});
  }

  const BudgetRules& rules_;
  const InstrumentModel& instrument_;
  const ReferenceStandard& standard_;
  const PairedPoint& p_;
  const DirectionSlopes& slopes_;
  TermList& terms_;
};

Brdf scatter(const PairedPoint& p, const InstrumentModel& instrument) {
  const double sample = p.dvalue_dq * root_sum(p.sample.u_noise, p.sample.u_monitor);
  const double reference = p.value * root_sum(p.reference.u_noise, p.reference.u_monitor) / p.reference.q;
  const double placing = p.value * instrument.lamp.u_reproducibility;
  const double placings = p.mode == ReferenceMode::SameGeometry ? 2.0 : 1.0;  // of an anchor it does not scatter
  return per_steradian(std::sqrt(sample * sample + reference * reference + placings * placing * placing));
}

BudgetRules::BudgetRules(const InstrumentModel& instrument, const ReferenceStandard& standard, bool has_trap_visits)
    : instrument_(instrument), standard_(standard), has_trap_visits_(has_trap_visits) {
  const AngleModel& angles = instrument.angles;
  u_zero_ = {angles.u_zero_theta_i.si(), angles.u_zero_theta_r.si(), angles.u_zero_phi_r.si()};
  const bool has_covariance = std::ranges::any_of(angles.zero_covariance, [](double c) { return c != 0.0; });
  if (has_covariance) {
    zero_factor_ = covariance_factor(angles.zero_covariance, kDirectionAxes);
    for (std::size_t a = 0; a < kDirectionAxes; ++a) u_zero_[a] = std::sqrt(angles.zero_covariance[4 * a]);
  }
  for (std::size_t a = 0; a < kDirectionAxes; ++a) {
    u_angle_[a] = root_sum(u_zero_[a], std::sqrt(moves_of(a)) * angles.u_repeat.si());
  }
  const LinearityModel& linearity = instrument.detector.linearity;
  const std::size_t n = std::min(linearity.coefficients.size(), kLinearityTerms) + 1;
  if (linearity.covariance.size() == n * n) linearity_factor_ = covariance_factor(linearity.covariance, n);
  if (!instrument.version.empty()) instrument_owner_ = "instrument " + instrument.version;
  standard_owner_ = "standard " + standard.serial() + " " + standard.certificate().date;
}

void BudgetRules::add_terms(const PairedPoint& point, const DirectionSlopes& slopes, const ConeCorrection& cones,
                            const SpectralSlope& spectral, TermList& terms) const {
  PointTerms(*this, point, slopes, terms).add();
  add_cone_terms(cones, instrument_, terms);
  add_polarisation_terms(point, instrument_, terms);
  add_mounting_terms(point, slopes, instrument_, terms);
  add_spectral_terms(spectral, point.wavelength, instrument_, terms);
}

Nonlinearity BudgetRules::nonlinearity(const PairedPoint& point, const DirectionSlopes& slopes) const {
  Nonlinearity bent{.u_angle = u_angle_};
  for (std::size_t a = 0; a < kDirectionAxes; ++a) {
    bent.slope[a] = slopes.slope[a] - point.value * point.standard.slope[a];
    bent.curvature[a] = slopes.curvature[a];
  }
  return bent;
}

}  // namespace gonio::calibration
