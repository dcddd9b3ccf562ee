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

void add_polarisation_terms(const PairedPoint& point, const InstrumentModel& instrument, TermList& terms) {
  if (!instrument.polarisation) return;
  const PolarisationModel& model = *instrument.polarisation;
  const double sign = point.polarisation == Polarisation::P ? -1.0 : 1.0;
  const double source = point.polarisation == Polarisation::Any ? model.source_degree : 1.0;
  const double detector = model.detector_diattenuation;
  const double facets = model.sample_index ? facet_diattenuation(point.sample.geometry, *model.sample_index) : 1.0;
  const std::string owner = instrument.version.empty() ? "" : "instrument " + instrument.version;
  const auto add = [&](std::int64_t part, double u, double per_sd, std::string_view what, std::string_view of) {
    terms.shared({ComponentSource::Polarisation, part}, u, "of its diattenuation", per_sd * u,
                 [&] { return fmt::format("polarisation of {}, by the {}", what, of); },
                 {.owner = owner, .is_pattern_known = false});
  };
  const double f = point.value;
  add(0, model.u_sample, f * sign * source * facets, "the sample", "source");
  add(1, model.u_sample, f * detector * facets, "the sample", "detector");
  add(2, model.u_sample, f * sign * source * detector, "the sample", "both");
  if (point.mode == ReferenceMode::Absolute) return;
  add(3, model.u_reference, -f * sign * source, "the reference", "source");
  add(4, model.u_reference, -f * detector, "the reference", "detector");
  add(5, model.u_reference, -f * sign * source * detector, "the reference", "both");
}

}  // namespace gonio::calibration
