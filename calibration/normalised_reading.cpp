#include "calibration/normalised_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/root_sum.h"

namespace gonio::calibration {
namespace {

double gain_factor(const RawFrame& frame, const DetectorModel& detector) {
  const double stated = frame.gain_db == 0.0 ? 1.0 : std::pow(10.0, frame.gain_db / 20.0);
  for (const GainFactor& gain : detector.gains) {
    if (std::abs(gain.gain_db - frame.gain_db) < 5e-4) return stated * gain.factor.value;
  }
  return stated;
}

double range_factor(const PowerReading& power, const DetectorModel& detector) {
  if (!detector.power) return 1.0;
  for (const RangeFactor& range : detector.power->ranges) {
    if (std::abs(range.range_w - power.range_w) < 1e-6 * power.range_w) return range.factor.value;
  }
  return 1.0;
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
double noise_variance(const RawFrame& frame, double net, double gain, const DarkLevel& dark,
                      const DetectorModel& detector) {
  if (frame.reduced) return frame.reduced->u_noise_dn * frame.reduced->u_noise_dn;
  const double shot = std::max(0.0, net) * gain / detector.electrons_per_dn;
  return (dark.pixel_variance_dn2 + shot) / frame.region.n;
}

struct FrameTerm {
  double net = 0.0;       // DN, or W: linearised
  double light = 0.0;     // E m
  double ambient = 0.0;   // E: what the ambient light has acted through
  double variance = 0.0;  // of net, without the dark level's own
  double u_light = 0.0;   // from the monitor's noise
  double share = 0.0;     // the signal as the detector's linearity sees it: DN, or a part of the range
  double gain_monitor = 0.0;
  double slope = 1.0;  // d net / d signal
  LinearityPowers powers{};
};

// Of the sum of the net means, from their scatter about q times their light: sqrt(m) s. The monitor's noise is in it
// too.
double scatter(const std::vector<FrameTerm>& terms, double q) {
  double squares = 0.0;
  for (const FrameTerm& term : terms) squares += std::pow(term.net - q * term.light, 2);
  const auto m = static_cast<double>(terms.size());
  return std::sqrt(squares * m / (m - 1.0));
}

// What the frame's term is made with.
struct Clearing {
  const RawFrame& frame;
  const DetectorModel& detector;
  const LeftOut& left_out;
  double dark_dn;
  double monitor;
  double u_monitor;
};

void linearise(FrameTerm& term, const Clearing& with, double full_scale) {
  const LinearityModel& model = with.detector.linearity;
  if (model.coefficients.empty() && model.covariance.empty()) return;
  const bool has_pixels = !with.frame.power && !with.frame.reduced;
  term.powers = linearity_powers(term.net, full_scale, has_pixels ? &with.frame.region : nullptr);
  if (with.left_out.linearity) return;
  const double x = term.net / full_scale;
  double power = 1.0;
  for (std::size_t k = 0; k < std::min(model.coefficients.size(), kLinearityTerms); ++k) {
    power *= x;
    term.slope += static_cast<double>(k + 2) * model.coefficients[k] * power;
  }
  term.net += linearity_gain(model, term.powers);
}

FrameTerm camera_term(const Clearing& with, const DarkLevel& dark) {
  const RawFrame& frame = with.frame;
  const DetectorModel& detector = with.detector;
  const double gain = gain_factor(frame, detector);
  const double t0 = with.left_out.exposure_offset ? 0.0 : detector.exposure_offset_s.value;
  const double exposure = (frame.exposure_s + t0) * gain;
  FrameTerm term{.net = frame.signal_dn() - with.dark_dn, .light = exposure * with.monitor, .ambient = exposure};
  term.variance = noise_variance(frame, term.net, gain, dark, detector);
  term.u_light = exposure * with.u_monitor;
  term.share = term.net;
  term.gain_monitor = gain * with.monitor;
  linearise(term, with, detector.full_scale_dn);
  term.variance *= term.slope * term.slope;
  return term;
}

FrameTerm power_term(const Clearing& with) {
  const PowerReading& power = *with.frame.power;
  const double factor = range_factor(power, with.detector);
  FrameTerm term{.net = power.mean_w - with.dark_dn, .light = with.monitor / factor, .ambient = 1.0 / factor};
  term.variance = noise_variance_w2(with.detector.power.value_or(PowerModel{}), power);
  term.u_light = with.u_monitor / factor;
  term.share = term.net / power.range_w;
  linearise(term, with, power.range_w);
  term.variance *= term.slope * term.slope;
  return term;
}

FrameTerm term_of(const RawFrame& frame, const DarkLevel& dark, const ReadingContext& context) {
  const DetectorModel& detector = *context.detector;
  const double monitor = context.left_out.monitor ? 1.0 : frame.monitor_mean;
  const Clearing with{.frame = frame,
                      .detector = detector,
                      .left_out = context.left_out,
                      .dark_dn = context.left_out.dark ? 0.0 : dark.level_dn,
                      .monitor = monitor,
                      .u_monitor = root_sum(frame.monitor_se, detector.u_monitor_window * monitor)};
  return frame.power ? power_term(with) : camera_term(with, dark);
}

Error no_dark(const RawReading& reading, const RawFrame& frame) {
  if (frame.power) {
    return refusal(reading, ErrorCode::IncompleteData, "no dark in its range",
                   fmt::format("a dark visit in the range of {} W", frame.power->range_w));
  }
  return refusal(reading, ErrorCode::IncompleteData, "no dark at its exposure",
                 fmt::format("a dark visit at {} s and {} dB", frame.exposure_s, frame.gain_db));
}

// Where its darks are kept: a new entry for a rung's first frame. Null: there is no dark.
DarkShare* share_of(std::vector<DarkShare>& shares, const ExposureRung& rung, Instant when, const DarkHistory& darks) {
  const auto found = std::ranges::find(shares, rung, &DarkShare::rung);
  if (found != shares.end()) return &*found;
  DarkShare& share = shares.emplace_back();
  share.rung = rung;
  return darks.find(rung, when, share.level) ? &share : nullptr;
}

void add(FrameTerm& sum, const FrameTerm& term, double& monitor2) {
  sum.net += term.net;
  sum.light += term.light;
  sum.ambient += term.ambient;
  sum.variance += term.variance;
  sum.share += term.share;
  sum.gain_monitor += term.gain_monitor;
  for (std::size_t k = 0; k < kLinearityTerms; ++k) sum.powers[k] += term.powers[k];
  monitor2 += term.u_light * term.u_light;
}

// The ambient light has come through each frame's exposure and gain, the lamp's stray light with the lamp itself.
void subtract_background(const RawReading& reading, const ReadingContext& context, FrameTerm& sum,
                         std::vector<FrameTerm>& terms, NormalisedReading& out) {
  if (context.ambient != nullptr) out.ambient = context.ambient->at(reading.light_class, reading.at);
  if (!out.ambient) return;
  const double level = context.left_out.ambient ? 0.0 : out.ambient->level;
  sum.net -= level * sum.ambient;
  for (FrameTerm& term : terms) term.net -= level * term.ambient;
}

void judge_frames(const std::vector<FrameTerm>& terms, double light, const DetectorModel& detector,
                  NormalisedReading& out) {
  for (const FrameTerm& term : terms) {
    out.frame_chi2 += std::pow(term.net - out.q * term.light, 2) / (term.variance + std::pow(out.q * term.u_light, 2));
  }
  if (detector.noise == NoiseSource::RepeatedFrames && terms.size() > 1) {
    out.u_noise = scatter(terms, out.q) / light;
    out.noise_dof = out.frame_dof;
  }
}

void finish(const FrameTerm& sum, double monitor2, double frames, NormalisedReading& out) {
  out.q = sum.net / sum.light;
  out.u_noise = std::sqrt(sum.variance) / sum.light;
  out.u_monitor = std::abs(sum.net) * std::sqrt(monitor2) / (sum.light * sum.light);
  out.dlnq_dt0 = -sum.gain_monitor / sum.light;
  out.mean_net_dn = sum.share / frames;
  out.frame_dof = frames - 1.0;
  out.dq_dambient = -sum.ambient / sum.light;
  for (std::size_t k = 0; k < kLinearityTerms; ++k) out.dq_dlinearity[k] = sum.powers[k] / sum.light;
  for (DarkShare& share : out.darks) {
    share.dq_dlevel /= sum.light;
    share.light_share /= sum.light;
  }
  if (out.darks.size() > 1) std::ranges::sort(out.darks, {}, &DarkShare::rung);
}

// Of what served another reading, all that `finish` does not set.
void begin_anew(const RawReading& reading, NormalisedReading& out) {
  out.noise_dof = std::numeric_limits<double>::infinity();
  out.frame_chi2 = 0.0;
  out.has_saturated = reading.has_saturated;
  out.darks.clear();
  out.ambient.reset();
  out.stray.reset();
  out.geometry = mean_geometry(reading.frames);
  out.at = reading.at;
}

// What light acts through: of two frames of one reading the one with more saturates first.
double reach_of(const RawFrame& frame) {
  return frame.exposure_s * std::pow(10.0, frame.gain_db / 20.0);
}

bool is_saturated(const RawFrame& frame) {
  return !frame.power && frame.region.saturated > 0;
}

// Without the exposures from the shortest saturated one on.
RawReading without_saturated(const RawReading& reading) {
  double limit = INFINITY;
  for (const RawFrame& frame : reading.frames) {
    if (is_saturated(frame)) limit = std::min(limit, reach_of(frame));
  }
  constexpr double kSame = 1.0 - 1e-9;
  RawReading rest = reading;
  std::erase_if(rest.frames, [&](const RawFrame& frame) { return reach_of(frame) >= kSame * limit; });
  return rest;
}

}  // namespace

Result<void> normalise(const RawReading& reading, const ReadingContext& context, NormalisedReading& out) {
  if (std::ranges::any_of(reading.frames, is_saturated)) {
    const RawReading rest = without_saturated(reading);
    if (!rest.frames.empty()) {
      auto shorter = normalise(rest, context, out);
      out.has_saturated = true;
      return shorter;
    }
  }
  GONIO_TRY(check(reading));
  begin_anew(reading, out);
  std::vector<FrameTerm> terms;  // of a single frame nothing is to be judged
  FrameTerm sum;
  double monitor2 = 0.0;
  for (const RawFrame& frame : reading.frames) {
    DarkShare* const share = share_of(out.darks, rung_of(frame), reading.at, *context.darks);
    if (share == nullptr) return failure(no_dark(reading, frame));
    const FrameTerm term = term_of(frame, share->level, context);
    if (reading.frames.size() > 1) terms.push_back(term);
    add(sum, term, monitor2);
    share->dq_dlevel -= term.slope;
    share->light_share += term.light;
  }
  subtract_background(reading, context, sum, terms, out);
  finish(sum, monitor2, static_cast<double>(reading.frames.size()), out);
  judge_frames(terms, sum.light, *context.detector, out);
  if (context.stray != nullptr) out.stray = context.stray->at(reading.light_class, reading.at);
  if (out.stray && !context.left_out.stray) out.q -= out.stray->level;
  return {};
}

Result<NormalisedReading> normalise(const RawReading& reading, const ReadingContext& context) {
  NormalisedReading out;
  GONIO_TRY(normalise(reading, context, out));
  return out;
}

Result<NormalisedReading> normalise(const RawReading& reading, const DarkHistory& darks,
                                    const DetectorModel& detector) {
  return normalise(reading, ReadingContext{.darks = &darks, .detector = &detector});
}

}  // namespace gonio::calibration
