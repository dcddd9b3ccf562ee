#include "calibration/polarisation_term.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

namespace gonio::calibration {

double facet_diattenuation(const Geometry& g, double n) {
  const double half = 0.5 * phase_angle(g).si();
  const double c = std::cos(half);
  const double t = std::sqrt(1.0 - std::sin(half) * std::sin(half) / (n * n));
  const double s_amplitude = (c - n * t) / (c + n * t);
  const double p_amplitude = (n * c - t) / (n * c + t);
  const double s = s_amplitude * s_amplitude;
  const double p = p_amplitude * p_amplitude;
  return (s - p) / (s + p);
}

PlaneTurn facet_turn(Angle own_theta, Angle other_theta, Angle dphi) {
  // What the other direction has along growing theta and along growing phi of the own one.
  const double sine = std::sin(other_theta.si());
  const double along =
      sine * std::cos(dphi.si()) * std::cos(own_theta.si()) - std::cos(other_theta.si()) * std::sin(own_theta.si());
  const double across = sine * std::sin(dphi.si());
  const double size2 = along * along + across * across;
  if (size2 < 1e-24) return {};
  return {.cosine = (along * along - across * across) / size2, .sine = 2.0 * along * across / size2};
}

namespace {

/// Adds the terms of one point.
class PolarisationTerms {
 public:
  PolarisationTerms(const PairedPoint& point, const InstrumentModel& instrument, TermList& terms)
      : point_(point),
        model_(*instrument.polarisation),
        owner_(instrument.version.empty() ? "" : "instrument " + instrument.version),
        source_(point.polarisation == Polarisation::Any ? model_.source_degree
                : point.polarisation == Polarisation::P ? -1.0
                                                        : 1.0),
        terms_(terms) {}

  void add() {
    const double detector = model_.detector_diattenuation;
    if (model_.sample_index) {
      add_facets(detector);
    } else {
      add_unknown(0, model_.u_sample, source_, "the sample, by the source");
      add_unknown(1, model_.u_sample, detector, "the sample, by the detector");
      add_unknown(2, model_.u_sample, source_ * detector, "the sample, by both");
    }
    if (point_.mode == ReferenceMode::Absolute) return;
    add_unknown(3, model_.u_reference, -source_, "the reference, by the source");
    add_unknown(4, model_.u_reference, -detector, "the reference, by the detector");
    add_unknown(5, model_.u_reference, -source_ * detector, "the reference, by both");
  }

 private:
  // Of a plane that nobody knows the two components by cos 2 psi and sin 2 psi have the same u and no correlation.
  void add_facets(double detector) {
    const Geometry& g = point_.sample.geometry;
    const double facets = facet_diattenuation(g, *model_.sample_index);
    const PlaneTurn at_source = facet_turn(g.theta_i, g.theta_r, g.phi_r - g.phi_i);
    const PlaneTurn at_detector = facet_turn(g.theta_r, g.theta_i, g.phi_i - g.phi_r);
    add_plane(0, source_ * facets, at_source, "the sample, by the source");
    add_plane(1, detector * facets, at_detector, "the sample, by the detector");
    add_unknown(2, model_.u_sample, source_ * detector * facets, "the sample, by both");
  }

  void add_plane(std::int64_t part, double size, const PlaneTurn& turn, std::string_view of) {
    ComponentTraits traits{.owner = owner_};
    if (is_of_any_plane()) {
      traits.distribution = Distribution::Arcsine;
      traits.unknown_angle = static_cast<std::uint8_t>(part);
    }
    add_one({ComponentSource::Polarisation, part, 0}, model_.u_sample, size * turn.cosine, traits,
            [&] { return fmt::format("polarisation of {}, along", of); });
    add_one({ComponentSource::Polarisation, part, 1}, model_.u_sample, size * turn.sine, traits,
            [&] { return fmt::format("polarisation of {}, at 45 deg", of); });
  }

  // As it is stated in two digits, too. Of a plane that is known in part no distribution is known.
  [[nodiscard]] bool is_of_any_plane() const { return std::abs(model_.u_sample - kOfAnyPlane) < 0.01; }

  void add_unknown(std::int64_t part, double u, double size, std::string_view of) {
    add_one({ComponentSource::Polarisation, part}, u, size, {.owner = owner_, .is_pattern_known = false},
            [&] { return fmt::format("polarisation of {}", of); });
  }

  template <class Name>
  void add_one(const ComponentTable::Key& key, double u, double size, const ComponentTraits& traits, const Name& name) {
    terms_.shared(key, u, "of its diattenuation", point_.value * size * u, name, traits);
  }

  const PairedPoint& point_;
  const PolarisationModel& model_;
  std::string owner_;
  double source_;
  TermList& terms_;
};

}  // namespace

void add_polarisation_terms(const PairedPoint& point, const InstrumentModel& instrument, TermList& terms) {
  if (instrument.polarisation) PolarisationTerms(point, instrument, terms).add();
}

}  // namespace gonio::calibration
