#include "calibration/normalised_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace gonio::calibration {
namespace {

double gain_factor(const RawFrame& frame) {
  return std::pow(10.0, frame.gain_db / 20.0);
}

Error refusal(const RawReading& reading, ErrorCode code, std::string seen, std::string limit) {
  return {.code = code,
          .device = "detector",
          .tried = fmt::format("calibrate reading {}", reading.id),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

Result<void> check_power(const RawReading& reading, const RawFrame& frame) {
  if (frame.power->samples > 0 && frame.power->range_w > 0.0 && frame.monitor_mean > 0.0) return {};
  return failure(refusal(reading, ErrorCode::IncompleteData,
                         fmt::format("{} samples in a range of {} W, monitor {}", frame.power->samples,
                                     frame.power->range_w, frame.monitor_mean),
                         "all of them above 0"));
}

Result<void> check(const RawReading& reading) {
  if (reading.frames.empty()) {
    return failure(refusal(reading, ErrorCode::IncompleteData, "no frame", "at least one frame"));
  }
  for (const RawFrame& frame : reading.frames) {
    if (frame.power) {
      GONIO_TRY(check_power(reading, frame));
      continue;
    }
    if (frame.region.saturated > 0) {
      return failure(refusal(reading, ErrorCode::Saturated, fmt::format("{} saturated pixels", frame.region.saturated),
                             "none inside the aperture"));
    }
    if (frame.reduced.has_value() != reading.frames.front().reduced.has_value()) {
      return failure(refusal(reading, ErrorCode::IncompleteData, "some frames reduced by maps and some not",
                             "all of them, or none"));
    }
    if (frame.region.n == 0 || !(frame.exposure_s > 0.0) || !(frame.monitor_mean > 0.0)) {
      return failure(refusal(
          reading, ErrorCode::IncompleteData,
          fmt::format("{} pixels, exposure {} s, monitor {}", frame.region.n, frame.exposure_s, frame.monitor_mean),
          "all of them above 0"));
    }
  }
  return {};
}

// Angles averaged as differences from the first, so that azimuths may cross 360 deg.
Geometry mean_geometry(const std::vector<RawFrame>& frames) {
  const Geometry first = frames.front().at_open;
  Geometry sum{};
  const auto add = [&](const Geometry& g) {
    sum.theta_i += g.theta_i - first.theta_i;
    sum.phi_i += wrapped(g.phi_i - first.phi_i);
    sum.theta_r += g.theta_r - first.theta_r;
    sum.phi_r += wrapped(g.phi_r - first.phi_r);
  };
  for (const RawFrame& frame : frames) {
    add(frame.at_open);
    add(frame.at_close);
  }
  const double share = 0.5 / static_cast<double>(frames.size());
  return {.theta_i = first.theta_i + share * sum.theta_i,
          .phi_i = first.phi_i + share * sum.phi_i,
          .theta_r = first.theta_r + share * sum.theta_r,
          .phi_r = first.phi_r + share * sum.phi_r};
}

// Of a frame's net mean, DN^2.
double noise_variance(const RawFrame& frame, double net, const DarkLevel& dark, const DetectorModel& detector) {
  if (frame.reduced) return frame.reduced->u_noise_dn * frame.reduced->u_noise_dn;
  const double shot = std::max(0.0, net) * gain_factor(frame) / detector.electrons_per_dn;
  return (dark.pixel_variance_dn2 + shot) / frame.region.n;
}

struct FrameTerm {
  double net = 0.0;       // DN, or W
  double light = 0.0;     // (t + t0) G m, or m
  double variance = 0.0;  // of net, without the dark level's own
  double u_light = 0.0;   // from the monitor's noise
  double share = 0.0;     // net as the detector's linearity sees it: DN, or a part of the range
  double gain_monitor = 0.0;
};

// Of the sum of the net means, from their scatter about q times their light: sqrt(m) s. The monitor's noise is in it
// too.
double scatter(const std::vector<FrameTerm>& terms, double q) {
  double squares = 0.0;
  for (const FrameTerm& term : terms) squares += std::pow(term.net - q * term.light, 2);
  const auto m = static_cast<double>(terms.size());
  return std::sqrt(squares * m / (m - 1.0));
}

double u_monitor(const RawFrame& frame, const DetectorModel& detector) {
  return std::hypot(frame.monitor_se, detector.u_monitor_window * frame.monitor_mean);
}

FrameTerm camera_term(const RawFrame& frame, const DarkLevel& dark, const DetectorModel& detector) {
  const double gain = gain_factor(frame);
  const double exposure = (frame.exposure_s + detector.exposure_offset_s.value) * gain;
  FrameTerm term{.net = frame.signal_dn() - dark.level_dn, .light = exposure * frame.monitor_mean};
  term.variance = noise_variance(frame, term.net, dark, detector);
  term.u_light = exposure * u_monitor(frame, detector);
  term.share = term.net;
  term.gain_monitor = gain * frame.monitor_mean;
  return term;
}

FrameTerm power_term(const RawFrame& frame, const DarkLevel& dark, const DetectorModel& detector) {
  const PowerReading& power = *frame.power;
  FrameTerm term{.net = power.mean_w - dark.level_dn, .light = frame.monitor_mean};
  term.variance = noise_variance_w2(detector.power.value_or(PowerModel{}), power);
  term.u_light = u_monitor(frame, detector);
  term.share = term.net / power.range_w;
  return term;
}

Error no_dark(const RawReading& reading, const RawFrame& frame) {
  if (frame.power) {
    return refusal(reading, ErrorCode::IncompleteData, "no dark in its range",
                   fmt::format("a dark visit in the range of {} W", frame.power->range_w));
  }
  return refusal(reading, ErrorCode::IncompleteData, "no dark at its exposure",
                 fmt::format("a dark visit at {} s and {} dB", frame.exposure_s, frame.gain_db));
}

}  // namespace

Result<NormalisedReading> normalise(const RawReading& reading, const DarkHistory& darks,
                                    const DetectorModel& detector) {
  GONIO_TRY(check(reading));
  std::map<ExposureRung, DarkShare> shares;
  std::vector<FrameTerm> terms;
  FrameTerm sum;
  double monitor2 = 0.0;
  for (const RawFrame& frame : reading.frames) {
    const ExposureRung rung = rung_of(frame);
    const std::optional<DarkLevel> dark = darks.at(rung, reading.at);
    if (!dark) return failure(no_dark(reading, frame));
    const FrameTerm& term =
        terms.emplace_back(frame.power ? power_term(frame, *dark, detector) : camera_term(frame, *dark, detector));
    sum.net += term.net;
    sum.light += term.light;
    sum.variance += term.variance;
    sum.share += term.share;
    sum.gain_monitor += term.gain_monitor;
    monitor2 += term.u_light * term.u_light;
    shares.try_emplace(rung, DarkShare{rung, *dark, 0.0}).first->second.dq_dlevel -= 1.0;
  }
  NormalisedReading out{.q = sum.net / sum.light,
                        .u_noise = std::sqrt(sum.variance) / sum.light,
                        .u_monitor = std::abs(sum.net) * std::sqrt(monitor2) / (sum.light * sum.light),
                        .dlnq_dt0 = -sum.gain_monitor / sum.light,
                        .mean_net_dn = sum.share / static_cast<double>(reading.frames.size()),
                        .frame_dof = static_cast<double>(reading.frames.size()) - 1.0,
                        .geometry = mean_geometry(reading.frames),
                        .at = reading.at};
  for (const FrameTerm& term : terms) {
    out.frame_chi2 += std::pow(term.net - out.q * term.light, 2) / (term.variance + std::pow(out.q * term.u_light, 2));
  }
  if (detector.noise == NoiseSource::RepeatedFrames && terms.size() > 1) {
    out.u_noise = scatter(terms, out.q) / sum.light;
    out.noise_dof = out.frame_dof;
  }
  for (auto& [rung, share] : shares) {
    share.dq_dlevel /= sum.light;
    out.darks.push_back(std::move(share));
  }
  return out;
}

}  // namespace gonio::calibration
