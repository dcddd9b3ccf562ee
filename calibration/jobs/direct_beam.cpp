#include "calibration/jobs/direct_beam.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "calibration/dark_history.h"
#include "calibration/jobs/beam_readings.h"

namespace gonio::calibration {

namespace {

constexpr double kUnevenAtMost = 0.01;  // relative: more is an edge of the beam, or of the stop
constexpr std::string_view kBeamPrefix = "direct_beam_";

Error no_beam(double nm, std::string seen, std::string limit) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = fmt::format("find the direct beam at {:g} nm", nm),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

struct WeightedMean {
  double value = 0.0;
  double u = 0.0;
  double chi2 = 0.0;
};

template <class Wanted>
std::optional<WeightedMean> beam_mean(const std::vector<BeamReading>& readings, Wanted is_wanted) {
  double weights = 0.0;
  double sum = 0.0;
  for (const BeamReading& one : readings) {
    if (!is_wanted(one)) continue;
    weights += 1.0 / (one.u * one.u);
    sum += one.read.q / (one.u * one.u);
  }
  if (weights == 0.0) return std::nullopt;
  WeightedMean mean{.value = sum / weights, .u = 1.0 / std::sqrt(weights)};
  for (const BeamReading& one : readings) {
    if (is_wanted(one)) mean.chi2 += std::pow((one.read.q - mean.value) / one.u, 2);
  }
  return mean;
}

// The largest part of q by which a place beside the beam differs from its middle, beyond the noise of both.
Result<double> beam_unevenness(double nm, const std::vector<BeamReading>& readings, const WeightedMean& middle) {
  double worst = 0.0;
  for (const BeamReading& at : readings) {
    if (is_straight(at.planned)) continue;
    const auto beside = beam_mean(readings, [&](const BeamReading& one) { return one.place == at.place; });
    const double off = beside->value / middle.value - 1.0;
    const double noise = std::hypot(beside->u, middle.u) / middle.value;
    if (std::abs(off) - 4.0 * noise > kUnevenAtMost) {
      return failure(
          no_beam(nm,
                  fmt::format("{:+.1f} % at theta_r {:g}, phi_r {:g} deg beside its middle", 100.0 * off,
                              1e-3 * static_cast<double>(at.place.first), 1e-3 * static_cast<double>(at.place.second)),
                  "1 %: the whole beam on the detector there, too"));
    }
    worst = std::max(worst, std::sqrt(std::max(0.0, off * off - noise * noise)));
  }
  return worst;
}

void put_values(FoundValues& found, const DirectBeam& beam) {
  const auto add = [&](std::string_view what, std::string unit, double value, double u) {
    found.values.push_back({.name = fmt::format("{}{}_{}", kBeamPrefix, what, nm_text(beam.wavelength)),
                            .unit = std::move(unit),
                            .value = value});
    found.covariance.push_back(u * u);  // the diagonal: spread out when all are there
  };
  add("q", "per unit of the monitor", beam.q.value, beam.q.u);
  add("attenuation", "1", beam.attenuation.value, beam.attenuation.u);
  add("dof", "1", std::isfinite(beam.degrees_of_freedom) ? beam.degrees_of_freedom : 0.0, 0.0);
  add("net", "DN", beam.mean_net_dn, 0.0);
  add("dlnq_dt0", "1/s", beam.dlnq_dt0, 0.0);
}

struct FoundBeam {
  DirectBeam beam;
  std::string note;
};

Result<FoundBeam> beam_of(double nm, const std::vector<BeamReading>& readings, const InstrumentModel& instrument,
                          const Measured<double>& passed) {
  const auto middle = beam_mean(readings, [](const BeamReading& one) { return is_straight(one.planned); });
  const auto all = beam_mean(readings, [](const BeamReading&) { return true; });
  if (!middle || !(middle->value > 0.0)) {
    return failure(no_beam(nm, middle ? "no light straight through" : "no reading straight through", "some"));
  }
  const Result<double> uneven = beam_unevenness(nm, readings, *middle);
  if (!uneven) return failure(uneven.error());
  const double dof = static_cast<double>(readings.size()) - 1.0;
  const double ratio = dof > 0.0 ? all->chi2 / dof : 1.0;
  const double noise = all->u * std::sqrt(std::max(1.0, ratio));
  std::vector<double> weights;
  for (const BeamReading& one : readings) weights.push_back(std::pow(all->u / one.u, 2));
  const double darks = u_of_darks(readings, weights, instrument.detector.u_dark_drift_dn_per_s);
  const double sides = *uneven * all->value / std::sqrt(3.0);
  DirectBeam beam{
      .wavelength = nanometres(nm), .q = {all->value, std::hypot(noise, darks, sides)}, .attenuation = passed};
  if (ratio > 1.0) beam.degrees_of_freedom = dof;
  for (const BeamReading& one : readings) {
    beam.mean_net_dn += one.read.mean_net_dn / static_cast<double>(readings.size());
    beam.dlnq_dt0 += one.read.dlnq_dt0 / static_cast<double>(readings.size());
  }
  std::string note = fmt::format(
      "{:g} nm: {} readings, chi-square {:.2f} a degree of freedom{}; beside the beam within {:.2f} %; behind {:.4g}",
      nm, readings.size(), ratio, ratio > 1.0 ? fmt::format(", so u is larger by {:.2f}", std::sqrt(ratio)) : "",
      100.0 * *uneven, passed.value);
  return FoundBeam{std::move(beam), std::move(note)};
}

// The wavelength that a name ends in, "568nm"; none.
std::optional<double> nm_of(std::string_view name, std::string_view what) {
  const std::string begin = fmt::format("{}{}_", kBeamPrefix, what);
  if (!name.starts_with(begin) || !name.ends_with("nm")) return std::nullopt;
  double nm = 0.0;
  const char* const end = name.data() + name.size() - 2;
  const auto [rest, error] = std::from_chars(name.data() + begin.size(), end, nm);
  return error == std::errc() && rest == end ? std::optional(nm) : std::nullopt;
}

}  // namespace

Result<FoundValues> fit_direct_beam(const ScanReadings& scan, const InstrumentModel& instrument,
                                    const std::vector<Attenuator>& attenuators) {
  const DarkHistory darks(scan, instrument.detector);
  const Result<BeamReadings> readings = beam_readings_of(scan, instrument, darks);
  if (!readings) return failure(readings.error());
  FoundValues found;
  for (const auto& [picometres, at_wavelength] : *readings) {
    const double nm = 1e-3 * static_cast<double>(picometres);
    const auto attenuator = std::ranges::find_if(attenuators, [wanted = picometres](const Attenuator& one) {
      return std::llround(in_nanometres(one.wavelength) * 1e3) == wanted;
    });
    if (attenuator == attenuators.end()) return failure(no_beam(nm, "no attenuator", "one, with its certificate"));
    const Result<FoundBeam> beam = beam_of(nm, at_wavelength, instrument, attenuator->passed);
    if (!beam) return failure(beam.error());
    put_values(found, beam->beam);
    found.note += (found.note.empty() ? "" : "; ") + beam->note;
  }
  if (found.values.empty()) {
    return failure({.code = ErrorCode::IncompleteData,
                    .device = "detector",
                    .tried = "find the direct beam",
                    .seen = "no readings",
                    .limit = "some straight through"});
  }
  spread_diagonal(found);
  return found;
}

std::vector<DirectBeam> direct_beams_of(const FoundValues& found) {
  std::vector<DirectBeam> beams;
  for (std::size_t place = 0; place < found.values.size(); ++place) {
    const auto nm = nm_of(found.values[place].name, "q");
    if (!nm) continue;
    const auto part = [&](std::string_view what) -> Measured<double> {
      const auto at = found.place_of(fmt::format("{}{}_{}", kBeamPrefix, what, nm_text(nanometres(*nm))));
      return at ? Measured<double>{found.values[*at].value, found.u(*at)} : Measured<double>{};
    };
    DirectBeam beam{.wavelength = nanometres(*nm),
                    .q = part("q"),
                    .mean_net_dn = part("net").value,
                    .dlnq_dt0 = part("dlnq_dt0").value,
                    .attenuation = part("attenuation")};
    if (const double dof = part("dof").value; dof > 0.0) beam.degrees_of_freedom = dof;
    beams.push_back(beam);
  }
  return beams;
}

}  // namespace gonio::calibration
