#include "calibration/spectral_term.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

namespace gonio::calibration {
namespace {

using PlanPlace = std::array<std::int64_t, 4>;

PlanPlace plan_place(const Geometry& g) {
  const auto key = [](Angle a) { return std::llround(in_degrees(a) * 1e3); };
  return {key(g.theta_i), key(g.phi_i), key(g.theta_r), key(g.phi_r)};
}

// Of the parabola through three points (or the line through two) at the middle one or, at an end, at the end.
SpectralSlope slope_among(std::span<const SpectralPoint> points, std::span<const std::size_t> group, std::size_t own) {
  if (group.size() < 2) return {};
  const SpectralPoint& p = points[group[own]];
  const auto rise = [&](std::size_t a, std::size_t b) {
    const SpectralPoint& from = points[group[a]];
    const SpectralPoint& to = points[group[b]];
    return (to.over_certificate - from.over_certificate) / (to.wavelength - from.wavelength).si();
  };
  if (group.size() == 2) return {.per_metre = p.certificate * rise(0, 1)};
  const std::size_t first = std::clamp<std::size_t>(own, 1, group.size() - 2) - 1;
  const double span = (points[group[first + 2]].wavelength - points[group[first]].wavelength).si();
  const double bend = (rise(first + 1, first + 2) - rise(first, first + 1)) / span;
  const double x = p.wavelength.si();
  const double x0 = points[group[first]].wavelength.si();
  const double x1 = points[group[first + 1]].wavelength.si();
  return {.per_metre = p.certificate * (rise(first, first + 1) + bend * (2.0 * x - x0 - x1)),
          .per_square_metre = p.certificate * 2.0 * bend};
}

}  // namespace

std::vector<SpectralSlope> spectral_slopes(std::span<const SpectralPoint> points) {
  std::vector<SpectralSlope> slopes(points.size());
  std::vector<PlanPlace> places(points.size());
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t n = 0; n < points.size(); ++n) places[n] = plan_place(points[n].planned);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return places[a] != places[b] ? places[a] < places[b] : points[a].wavelength < points[b].wavelength;
  });
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first + 1;
    while (last < order.size() && places[order[last]] == places[order[first]] &&
           points[order[last]].wavelength > points[order[last - 1]].wavelength) {
      ++last;
    }
    const auto group = std::span(order).subspan(first, last - first);
    for (std::size_t own = 0; own < group.size(); ++own) slopes[group[own]] = slope_among(points, group, own);
    first = last;
  }
  return slopes;
}

void add_spectral_terms(const SpectralSlope& slope, Wavelength wavelength, const InstrumentModel& instrument,
                        TermList& terms) {
  if (!instrument.spectral) return;
  const SpectralModel& model = *instrument.spectral;
  const std::int64_t picometres = std::llround(in_nanometres(wavelength) * 1e3);
  const std::string owner = instrument.version.empty() ? "" : "instrument " + instrument.version;
  const auto nanometres_text = [&] { return fmt::format("{:g} nm", in_nanometres(wavelength)); };
  terms.shared({ComponentSource::Centroid, picometres}, in_nanometres(model.u_centroid), "nm",
               slope.per_metre * model.u_centroid.si(), [&] { return "wavelength of " + nanometres_text(); },
               {.owner = owner});
  const double width = model.bandwidth.si();
  terms.shared({ComponentSource::Bandwidth, picometres}, in_nanometres(model.bandwidth), "nm",
               slope.per_square_metre * width * width / 24.0, [&] { return "bandwidth at " + nanometres_text(); },
               {.owner = owner});
}

}  // namespace gonio::calibration
