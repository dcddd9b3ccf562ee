#include <fmt/format.h>

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calibration/calibrate.h"

namespace gonio::calibration {

namespace {

/// The text, line by line, with all digits.
class InputText {
 public:
  explicit InputText(std::string text) : text_(std::move(text)) {}
  void line(std::string_view name, std::initializer_list<double> values) {
    text_ += name;
    for (const double value : values) add(value);
    text_ += '\n';
  }
  void line(std::string_view name, std::span<const double> values) {
    text_ += name;
    for (const double value : values) add(value);
    text_ += '\n';
  }
  void say(std::string_view words) { text_ += words; }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  void add(double value) { text_ += fmt::format(" {:.17g}", value); }
  std::string text_;
};

void describe(const LeftOut& out, InputText& text) {
  const auto say = [&](bool is_out, std::string_view name) {
    if (is_out) text.say(fmt::format("without {}\n", name));
  };
  say(out.dark, "dark");
  say(out.ambient, "ambient");
  say(out.stray, "stray");
  say(out.linearity, "linearity");
  say(out.exposure_offset, "exposure offset");
  say(out.monitor, "monitor");
  say(out.shape, "shape");
  say(out.cones, "cones");
  say(out.mounting, "mounting");
  say(out.overlap, "overlap");
}

void describe(std::string_view name, const MountModel& m, InputText& text) {
  text.line(name, {m.lean_0.value.si(), m.lean_0.u.si(), m.lean_90.value.si(), m.lean_90.u.si(), m.height.value.si(),
                   m.height.u.si()});
  if (!m.mounting.empty()) text.say("mounting " + m.mounting + "\n");
}

void describe(const OverlapModel& o, InputText& text) {
  const auto size = [](const std::optional<Length>& radius) { return radius ? radius->si() : 0.0; };
  text.line("beams", {o.spot_radius.value.si(), o.spot_radius.u.si(), o.field_radius.value.si(), o.field_radius.u.si(),
                      size(o.sample_radius), size(o.reference_radius), o.u_target_radius.si(), o.u_spot_falloff,
                      o.u_field_falloff, o.u_offset.si()});
  for (const RadialNode& node : o.spot_profile) text.line("spot", {node.of_radius, node.value});
  for (const RadialNode& node : o.field_profile) text.line("field", {node.of_radius, node.value});
}

void describe(const AbsoluteModel& a, InputText& text) {
  text.line("direct beam", {a.aperture_radius.value.si(), a.aperture_radius.u.si(), a.aperture_distance.value.si(),
                            a.aperture_distance.u.si()});
  for (const DirectBeam& b : a.beams) {
    text.line("beam", {b.wavelength.si(), b.q.value, b.q.u, b.degrees_of_freedom, b.mean_net_dn, b.dlnq_dt0,
                       b.attenuation.value, b.attenuation.u});
  }
}

void describe_optional_parts(const InstrumentModel& i, InputText& text) {
  const DetectorModel& d = i.detector;
  if (d.noise == NoiseSource::RepeatedFrames) text.say("noise of repeated frames\n");
  if (!d.linearity.coefficients.empty()) text.line("linearity", d.linearity.coefficients);
  if (!d.linearity.covariance.empty()) text.line("linearity covariance", d.linearity.covariance);
  for (const GainFactor& g : d.gains) text.line("gain", {g.gain_db, g.factor.value, g.factor.u});
  if (d.u_ambient_dn_per_s > 0.0) text.line("ambient", {d.u_ambient_dn_per_s});
  if (d.power) {
    for (const RangeFactor& r : d.power->ranges) text.line("range", {r.range_w, r.factor.value, r.factor.u});
  }
  const AngleModel& a = i.angles;
  if (a.zero != decltype(a.zero){}) text.line("zeros", {a.zero[0].si(), a.zero[1].si(), a.zero[2].si()});
  if (a.zero_covariance != decltype(a.zero_covariance){}) text.line("zero covariance", a.zero_covariance);
  if (i.stray) {
    const StrayModel& s = *i.stray;
    text.line("stray", {s.source_share.value, s.source_share.u, s.internal_share.value, s.internal_share.u});
  }
  if (i.cones) {
    const ConeModel& c = *i.cones;
    text.line("cones",
              {c.source_half.value.si(), c.source_half.u.si(), c.detector_half.value.si(), c.detector_half.u.si()});
  }
  if (i.polarisation) {
    const PolarisationModel& p = *i.polarisation;
    text.line("polarisation",
              {p.source_degree, p.detector_diattenuation, p.u_sample, p.u_reference, p.sample_index.value_or(0.0)});
  }
  if (i.mounting) {
    describe("mount of the sample", i.mounting->sample, text);
    describe("mount of the reference", i.mounting->reference, text);
    text.line("source distance", {i.mounting->source_distance.si()});
  }
  if (i.spectral) text.line("spectral", {i.spectral->u_centroid.si(), i.spectral->bandwidth.si()});
  if (i.overlap) describe(*i.overlap, text);
  if (i.absolute) describe(*i.absolute, text);
  if (!i.version.empty()) text.say("instrument " + i.version + "\n");
}

}  // namespace

std::string describe_inputs(const InstrumentModel& instrument, const ReferenceStandard& standard,
                            const CalibrationOptions& options) {
  const DetectorModel& d = instrument.detector;
  const AngleModel& a = instrument.angles;
  const LampModel& l = instrument.lamp;
  const Certificate& c = standard.certificate();
  InputText text(fmt::format("{}\n", kCalibrationCode));
  if (!options.correct_drift) text.say("drift uncorrected\n");
  if (options.monte_carlo != MonteCarloUse::WhereNeeded || options.seed != 1) {
    text.say(fmt::format("Monte Carlo {} of seed {}\n", static_cast<int>(options.monte_carlo), options.seed));
  }
  describe(options.left_out, text);
  text.line("detector", {d.electrons_per_dn, d.read_noise_dn, d.full_scale_dn, d.exposure_offset_s.value,
                         d.exposure_offset_s.u, d.u_linearity, d.u_dark_drift_dn_per_s});
  if (d.u_monitor_window > 0.0) text.line("monitor", {d.u_monitor_window});
  if (d.power) text.line("radiometer", {d.power->noise, d.power->u_range, d.power->u_zero});
  text.line("angles", {a.u_zero_theta_i.si(), a.u_zero_theta_r.si(), a.u_zero_phi_r.si(), a.u_repeat.si()});
  text.line("lamp", {l.u_after_monitor, l.correlation_s, l.u_reproducibility, l.reproducibility_dof});
  describe_optional_parts(instrument, text);
  text.say(fmt::format("standard {} {} {}\n", standard.serial(), c.date, c.expires));
  text.line("certificate", {static_cast<double>(c.geometry), c.specular_port.value_or(Angle{}).si(), c.coverage_factor,
                            c.longest_gap.si()});
  for (const CertificateEntry& e : c.entries) text.line("entry", {e.wavelength.si(), e.reflectance, e.u});
  if (c.correlation != 1.0) text.line("correlation", {c.correlation});
  const ShapeTable& table = standard.shapes().front().table;
  for (const auto* grid : {&table.theta_i(), &table.theta_r(), &table.phi()}) {
    std::vector<double> nodes;
    for (const Angle angle : *grid) nodes.push_back(angle.si());
    text.line("grid", nodes);
  }
  for (const SpectralShape& shape : standard.shapes()) {
    if (standard.shapes().size() > 1) text.line("shape", {shape.wavelength.si()});
    text.line("values", shape.table.values());
  }
  for (const ShapeMode& m : standard.modes()) {
    text.line("mode " + m.name, {static_cast<double>(m.kind), m.u, m.width.si()});
  }
  text.line("integral", {standard.u_integral()});
  return text.take();
}

}  // namespace gonio::calibration
