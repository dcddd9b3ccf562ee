#include "calibration/jobs/signature.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calibration/jobs/beam_readings.h"
#include "calibration/jobs/crossing_width.h"
#include "calibration/jobs/even_beam.h"

namespace gonio::calibration {

namespace {

// Beyond it the stated noise would have to be more than twice as large: another beam is likelier than that.
constexpr double kNoDisc = 4.0;  // chi-square a degree of freedom

struct LookedPlace {
  BeamPlace beam;
  std::vector<std::size_t> readings;  // of the wavelength's
  std::vector<double> weights;        // of each in the place's q
  bool is_in_plane = false;
  bool is_across = false;
};

// Off straight through by the encoders, along theta_r and along phi_r; its length is the angle to straight through.
std::pair<double, double> off_straight(const Geometry& g) {
  const double straight = std::numbers::pi - g.theta_i.si();
  const double dphi = wrapped(g.phi_r - g.phi_i - degrees(180.0)).si();
  const double theta = g.theta_r.si();
  const double u = std::sin(theta) * std::cos(dphi) * std::cos(straight) - std::cos(theta) * std::sin(straight);
  const double v = std::sin(theta) * std::sin(dphi);
  const double w = std::sin(theta) * std::cos(dphi) * std::sin(straight) + std::cos(theta) * std::cos(straight);
  const double across = std::hypot(u, v);
  const double stretch = across > 0.0 ? std::atan2(across, w) / across : 1.0;
  return {stretch * u, stretch * v};
}

// The darks' errors are not random from place to place; but beside the beam they are larger than all noise, and without
// them in its u a place would claim to know that.
LookedPlace looked_place_of(const std::vector<BeamReading>& readings, std::vector<std::size_t> repeats,
                            double u_drift_dn_per_s) {
  constexpr Angle kOnLine = degrees(1e-3);
  const Geometry& planned = readings[repeats.front()].planned;
  LookedPlace place{
      .is_in_plane = std::abs(wrapped(planned.phi_r - planned.phi_i - degrees(180.0)).si()) < kOnLine.si(),
      .is_across = std::abs((planned.theta_r + planned.theta_i - degrees(180.0)).si()) < kOnLine.si()};
  double sum = 0.0;
  for (const std::size_t k : repeats) sum += 1.0 / (readings[k].u * readings[k].u);
  std::vector<BeamReading> of_place;
  for (const std::size_t k : repeats) {
    const BeamReading& one = readings[k];
    const auto [x, y] = off_straight(one.read.geometry);
    place.weights.push_back(1.0 / (one.u * one.u * sum));
    place.beam.q += place.weights.back() * one.read.q;
    place.beam.x += x / static_cast<double>(repeats.size());
    place.beam.y += y / static_cast<double>(repeats.size());
    of_place.push_back(one);
  }
  place.beam.u = std::hypot(1.0 / std::sqrt(sum), u_of_darks(of_place, place.weights, u_drift_dn_per_s));
  place.readings = std::move(repeats);
  return place;
}

std::vector<LookedPlace> places_of(const std::vector<BeamReading>& readings, const DetectorModel& detector) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> repeats;
  for (std::size_t k = 0; k < readings.size(); ++k) repeats[readings[k].place].push_back(k);
  std::vector<LookedPlace> places;
  for (auto& [at, some] : repeats)
    places.push_back(looked_place_of(readings, std::move(some), detector.u_dark_drift_dn_per_s));
  return places;
}

// What the darks' errors do to a result that follows the q of these places.
double u_by_darks(const std::vector<BeamReading>& readings, std::span<const LookedPlace* const> places,
                  std::span<const double> d_dq, const DetectorModel& detector) {
  std::vector<double> weights(readings.size(), 0.0);
  for (std::size_t p = 0; p < places.size(); ++p) {
    const LookedPlace& place = *places[p];
    for (std::size_t k = 0; k < place.readings.size(); ++k) weights[place.readings[k]] += d_dq[p] * place.weights[k];
  }
  return u_of_darks(readings, weights, detector.u_dark_drift_dn_per_s);
}

// Two axes lie between lamp and detector in each direction.
Angle u_pointing(const InstrumentModel& instrument) {
  return std::numbers::sqrt2 * instrument.angles.u_repeat;
}

Result<CrossingWidth> crossing_of(double nm, const std::vector<BeamReading>& readings,
                                  const std::vector<LookedPlace>& places, const InstrumentModel& instrument,
                                  bool is_in_plane) {
  std::vector<const LookedPlace*> of_line;
  std::vector<CrossingPlace> line;
  for (const LookedPlace& place : places) {
    if (!(is_in_plane ? place.is_in_plane : place.is_across)) continue;
    of_line.push_back(&place);
    line.push_back({.at = is_in_plane ? place.beam.x : place.beam.y, .q = place.beam.q, .u = place.beam.u});
  }
  const std::string tried = fmt::format("cross the direct beam at {:g} nm {}", nm,
                                        is_in_plane ? "in the plane of incidence" : "across the plane of incidence");
  Result<CrossingWidth> found = crossing_width(line, u_pointing(instrument), tried);
  if (!found) return found;
  const auto with_darks = [&](Measured<Angle>& value, const std::vector<double>& d_dq) {
    value.u = radians(std::hypot(value.u.si(), u_by_darks(readings, of_line, d_dq, instrument.detector)));
  };
  with_darks(found->width, found->dwidth_dq);
  with_darks(found->centre, found->dcentre_dq);
  return found;
}

// A line that passes the middle of a round beam at a distance meets each level nearer to its own middle.
void as_through_the_middle(CrossingWidth& crossing, Angle beside) {
  crossing.width.value = radians(std::hypot(crossing.width.value.si(), 2.0 * beside.si()));
}

struct RadiusFound {
  std::optional<Measured<Length>> found;
  std::string words;
};

// What chi-square a degree of freedom stays below in 99.9 % of all fits to noise alone (Wilson and Hilferty 1931).
double most_by_noise(double degrees_of_freedom) {
  constexpr double kNormal = 3.0902;
  const double spread = 2.0 / (9.0 * degrees_of_freedom);
  return std::pow(1.0 - spread + kNormal * std::sqrt(spread), 3);
}

std::string chi_square_words(double ratio, double degrees_of_freedom) {
  return fmt::format("chi-square {:.2f} a degree of freedom ({:g} of them{})", ratio, degrees_of_freedom,
                     ratio > most_by_noise(degrees_of_freedom)
                         ? fmt::format("; noise alone stays below {:.2f}", most_by_noise(degrees_of_freedom))
                         : "");
}

std::string spot_words(const Measured<Length>& radius, const std::optional<OverlapModel>& beams) {
  const std::string lines =
      fmt::format("[beams] spot_radius_mm = {:.4g} with u_spot_radius_mm = {:.2g} if the beam is parallel",
                  in_millimetres(radius.value), in_millimetres(radius.u));
  if (!beams) return lines;
  const double off = in_millimetres(radius.value - beams->spot_radius.value);
  const double expanded = 2.0 * in_millimetres(Length::from_si(std::hypot(radius.u.si(), beams->spot_radius.u.si())));
  return fmt::format("[beams] states {:.4g} mm, {} U = {:.2g} mm{}", in_millimetres(beams->spot_radius.value),
                     std::abs(off) <= expanded ? "the same within" : fmt::format("{:+.3g} mm off, beyond", off),
                     expanded, std::abs(off) <= expanded ? "" : "; " + lines);
}

RadiusFound radius_of(const std::vector<BeamReading>& readings, const std::vector<LookedPlace>& places,
                      Angle half_width, const InstrumentModel& instrument) {
  if (!instrument.absolute) return {.found = {}, .words = "no radius: [absolute] does not state the detector's stop"};
  std::vector<const LookedPlace*> all;
  std::vector<BeamPlace> beam_places;
  for (const LookedPlace& place : places) {
    all.push_back(&place);
    beam_places.push_back(place.beam);
  }
  const AbsoluteModel& absolute = *instrument.absolute;
  const auto beam = fit_even_beam(beam_places, {absolute.aperture_radius, absolute.aperture_distance},
                                  u_pointing(instrument), half_width);
  if (!beam) return {.found = {}, .words = "no radius: " + beam.error().seen};
  if (!(beam->degrees_of_freedom > 0.0)) return {.found = {}, .words = "no radius: too few places to judge it by"};
  const double ratio = beam->chi2 / beam->degrees_of_freedom;
  const std::string judged = chi_square_words(ratio, beam->degrees_of_freedom);
  if (ratio > kNoDisc) {
    return {.found = {},
            .words = "no even round beam, or arms that point worse than u_repeat says, so no radius: " + judged};
  }
  const double widening = std::sqrt(std::max(1.0, ratio));
  const double darks = u_by_darks(readings, all, beam->dradius_dq, instrument.detector);
  const Measured<Length> radius{beam->radius.value, Length::from_si(std::hypot(widening * beam->radius.u.si(), darks))};
  return {.found = radius,
          .words = fmt::format("an even beam of radius {:.4g} mm, u {:.2g} mm, at the stop: {}{}; {}",
                               in_millimetres(radius.value), in_millimetres(radius.u), judged,
                               ratio > 1.0 ? fmt::format(", so u is larger by {:.2f}", widening) : "",
                               spot_words(radius, instrument.overlap))};
}

// No crossing of two even cones is wider at half level than both together.
std::string cone_words(const CrossingWidth& plane, const CrossingWidth& across, const InstrumentModel& instrument) {
  if (!instrument.cones) return "";
  const ConeModel& cones = *instrument.cones;
  const Measured<Angle>& width =
      std::max(plane.width, across.width, [](const auto& a, const auto& b) { return a.value < b.value; });
  const Angle sum = 2.0 * (cones.source_half.value + cones.detector_half.value);
  const double expanded =
      2.0 * std::hypot(width.u.si(), 2.0 * cones.source_half.u.si(), 2.0 * cones.detector_half.u.si());
  const bool is_wider = (width.value - sum).si() > expanded;
  return fmt::format(
      "; the stated cones are {:.4g} deg wide together{}", in_degrees(sum),
      is_wider ? ": less than the crossing, so one of them is wider than stated" : ", no less than the crossing");
}

void put(FoundValues& found, std::string_view what, double nm, std::string unit, double value, double u) {
  found.values.push_back(
      {.name = fmt::format("signature_{}_{}", what, nm_text(nanometres(nm))), .unit = std::move(unit), .value = value});
  found.covariance.push_back(u * u);  // the diagonal: spread out when all are there
}

void put_angle(FoundValues& found, std::string_view what, double nm, const Measured<Angle>& angle) {
  put(found, what, nm, "deg", in_degrees(angle.value), in_degrees(angle.u));
}

Result<void> add_wavelength(FoundValues& found, double nm, const std::vector<BeamReading>& readings,
                            const InstrumentModel& instrument) {
  const std::vector<LookedPlace> places = places_of(readings, instrument.detector);
  Result<CrossingWidth> plane = crossing_of(nm, readings, places, instrument, true);
  if (!plane) return failure(plane.error());
  Result<CrossingWidth> across = crossing_of(nm, readings, places, instrument, false);
  if (!across) return failure(across.error());
  as_through_the_middle(*plane, across->centre.value);
  as_through_the_middle(*across, plane->centre.value);
  const RadiusFound radius = radius_of(readings, places, 0.5 * plane->width.value, instrument);
  put_angle(found, "width_plane", nm, plane->width);
  put_angle(found, "width_across", nm, across->width);
  put_angle(found, "centre_plane", nm, plane->centre);
  put_angle(found, "centre_across", nm, across->centre);
  if (radius.found) {
    put(found, "beam_radius", nm, "mm", in_millimetres(radius.found->value), in_millimetres(radius.found->u));
  }
  found.note +=
      fmt::format("{}{:g} nm: {} readings at {} places, {:.4g} deg wide in the plane and {:.4g} deg across; {}{}",
                  found.note.empty() ? "" : "; ", nm, readings.size(), places.size(), in_degrees(plane->width.value),
                  in_degrees(across->width.value), radius.words, cone_words(*plane, *across, instrument));
  return {};
}

}  // namespace

Result<FoundValues> fit_signature(const ScanReadings& scan, const InstrumentModel& instrument) {
  const DarkHistory darks(scan, instrument.detector);
  const Result<BeamReadings> readings = beam_readings_of(scan, instrument, darks);
  if (!readings) return failure(readings.error());
  FoundValues found;
  for (const auto& [picometres, at_wavelength] : *readings) {
    GONIO_TRY(add_wavelength(found, 1e-3 * static_cast<double>(picometres), at_wavelength, instrument));
  }
  if (found.values.empty()) {
    return failure({.code = ErrorCode::IncompleteData,
                    .device = "detector",
                    .tried = "find the instrument's signature",
                    .seen = "no readings",
                    .limit = "two crossings of the direct beam"});
  }
  spread_diagonal(found);
  return found;
}

}  // namespace gonio::calibration
