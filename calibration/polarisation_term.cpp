#include "calibration/polarisation_term.h"

#include <cmath>
#include <string>

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

void add_polarisation_terms(const PairedPoint& point, const InstrumentModel& instrument, TermList& terms) {
  if (!instrument.polarisation) return;
  const PolarisationModel& model = *instrument.polarisation;
  const double sign = point.polarisation == Polarisation::P ? -1.0 : 1.0;
  const double source = point.polarisation == Polarisation::Any ? model.source_degree : 1.0;
  const double detector = model.detector_diattenuation;
  const auto relative = [&](double diattenuation) {
    return sign * source * (diattenuation + detector) + detector * diattenuation;
  };
  const double facets = model.sample_index ? facet_diattenuation(point.sample.geometry, *model.sample_index) : 1.0;
  const std::string owner = instrument.version.empty() ? "" : "instrument " + instrument.version;
  terms.shared({ComponentSource::Polarisation, 0}, model.u_sample, "of its diattenuation",
               point.value * relative(facets) * model.u_sample, [] { return "polarisation of the sample"; });
  terms.shared({ComponentSource::Polarisation, 1}, model.u_reference, "of its diattenuation",
               -point.value * relative(1.0) * model.u_reference, [] { return "polarisation of the reference"; },
               {.owner = owner});
}

}  // namespace gonio::calibration
