#include "calibration/point_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gonio::calibration {
namespace {

constexpr std::array<std::string_view, kDirectionAxes> kAxisNames = {"theta_i", "theta_r", "phi_r"};

/// Collects the terms of one point.
class Terms {
 public:
  Terms(const PairedPoint& p, const DirectionSlopes& slopes, const InstrumentModel& instrument,
        const ReferenceStandard& standard, ComponentTable& table)
      : p_(p), slopes_(slopes), instrument_(instrument), standard_(standard), table_(table) {}

  Budget budget() {
    add_sample_scatter();
    add_reference_scatter();
    add_standard();
    add_zeros();
    add_detector();
    add_lamp();
    add_drift();
    add_ranges();
    add_darks(p_.sample, p_.dvalue_dq);
    add_darks(p_.reference, -p_.value / p_.reference.q);
    return make_budget(table_.components(), std::move(random_), std::move(shared_));
  }

 private:
  void add_random(ComponentSource source, std::string_view name, double u, std::string_view unit, double per_sd,
                  double degrees_of_freedom = INFINITY) {
    // Known equally well, it is one component: a reading of five frames and one of nine have two.
    const bool is_known = std::isinf(degrees_of_freedom);
    const std::int64_t worth = is_known ? 0 : std::llround(degrees_of_freedom);
    const std::uint32_t index = table_.index({source, worth, 0, 0}, [&] {
      return Component{std::string(name), ComponentKind::Random, u, std::string(unit), degrees_of_freedom};
    });
    random_.push_back({index, per_steradian(std::abs(per_sd))});
  }

  void add_shared(const ComponentTable::Key& key, std::string name, double u, std::string_view unit, double per_sd) {
    if (u == 0.0) return;
    const std::uint32_t index = table_.index(key, [&] {
      return Component{std::move(name), ComponentKind::Shared, u, std::string(unit)};
    });
    shared_.push_back({index, per_steradian(per_sd)});
  }

  void add_sample_scatter() {
    const double dof = instrument_.lamp.reproducibility_dof;
    const double u_placing = instrument_.lamp.u_reproducibility;
    add_random(ComponentSource::SampleNoise, "noise of the sample reading", 0.0, "sr^-1",
               p_.dvalue_dq * p_.sample.u_noise, p_.sample.noise_dof);
    add_random(ComponentSource::SampleMonitor, "monitor noise of the sample reading", 0.0, "sr^-1",
               p_.dvalue_dq * p_.sample.u_monitor);
    add_random(ComponentSource::SampleReproducibility, "reproducibility of the sample reading", u_placing, "1",
               p_.value * u_placing, dof);
    add_random(ComponentSource::SampleAngles, "angle repeatability of the sample reading",
               in_degrees(instrument_.angles.u_repeat), "deg", sample_repeat());
  }

  void add_reference_scatter() {
    const double f = p_.value;
    const double u_placing = instrument_.lamp.u_reproducibility;
    const double noise = f * p_.reference.u_noise / p_.reference.q;
    const double monitor = f * p_.reference.u_monitor / p_.reference.q;
    const double repeat = f * reference_repeat();
    if (p_.reference_is_shared) {
      const double all = std::sqrt(noise * noise + monitor * monitor + repeat * repeat + f * f * u_placing * u_placing);
      add_shared({ComponentSource::SharedReference, p_.reference_id, 0, 0},
                 fmt::format("reference reading {}", p_.reference_id), 1.0, "of its own u", std::copysign(all, -f));
      return;
    }
    add_random(ComponentSource::ReferenceNoise, "noise of the reference reading", 0.0, "sr^-1", noise,
               p_.reference.noise_dof);
    add_random(ComponentSource::ReferenceMonitor, "monitor noise of the reference reading", 0.0, "sr^-1", monitor);
    add_random(ComponentSource::ReferenceReproducibility, "reproducibility of the reference reading", u_placing, "1",
               f * u_placing, instrument_.lamp.reproducibility_dof);
    add_random(ComponentSource::ReferenceAngles, "angle repeatability of the reference reading",
               in_degrees(instrument_.angles.u_repeat), "deg", repeat);
  }

  // d ln f_ref / d angle of the shape table, over a quarter of a degree, within the table.
  [[nodiscard]] double reference_slope(std::size_t axis) const {
    constexpr Angle kStep = degrees(0.25);
    Geometry low = p_.reference.geometry;
    Geometry high = low;
    const auto angle = [&](Geometry& g) -> Angle& { return axis == 0 ? g.theta_i : axis == 1 ? g.theta_r : g.phi_r; };
    angle(low) -= kStep;
    angle(high) += kStep;
    if (axis < 2) angle(high) = std::min(angle(high), axis == 0 ? standard_.last_theta_i() : standard_.last_theta_r());
    const double change = standard_.shape(high) - standard_.shape(low);
    return change / ((angle(high) - angle(low)).si() * standard_.shape(p_.reference.geometry));
  }

  // In q_ref itself the cosine of the radiance mode stays; only in the ratio of two equal zeros does it cancel.
  [[nodiscard]] double reference_repeat() const {
    const double u = instrument_.angles.u_repeat.si();
    double sum = 0.0;
    for (std::size_t a = 0; a < kDirectionAxes; ++a) {
      const double slope = reference_slope(a) - (a == 0 ? std::tan(p_.reference.geometry.theta_i.si()) : 0.0);
      sum += times(a) * slope * slope;
    }
    return u * std::sqrt(sum);
  }

  [[nodiscard]] double sample_repeat() const {
    const double u = instrument_.angles.u_repeat.si();
    double sum = 0.0;
    for (std::size_t a = 0; a < kDirectionAxes; ++a) {
      const double cosine = a == 0 ? p_.value * std::tan(p_.sample.geometry.theta_i.si()) : 0.0;
      const double slope = slopes_.slope[a] - cosine;
      sum += times(a) * (slope * slope + slopes_.unresolved[a] * slopes_.unresolved[a]);
    }
    return u * std::sqrt(sum);
  }

  // phi_r - phi_i is made of two axes, each of which stops anew at every move.
  static double times(std::size_t axis) { return axis == 2 ? 2.0 : 1.0; }

  void add_standard() {
    const double f = p_.value;
    add_shared({ComponentSource::Certificate, 0, 0, 0}, "certificate", p_.rho.u / p_.rho.value, "1",
               f * p_.rho.u / p_.rho.value);
    for (std::size_t k = 0; k < standard_.modes().size(); ++k) {
      const ShapeMode& mode = standard_.modes()[k];
      add_shared({ComponentSource::ShapeMode, static_cast<std::int64_t>(k), 0, 0}, "shape mode " + mode.name, mode.u,
                 "1", f * standard_.mode(k, p_.reference.geometry) * mode.u);
    }
    add_shared({ComponentSource::ShapeIntegral, 0, 0, 0}, "shape integral", standard_.u_integral(), "1",
               f * standard_.u_integral());
    const Geometry& g = p_.reference.geometry;
    add_shared({ComponentSource::ShapeInterpolation, 0, 0, 0}, "shape between the nodes of its table", 1.0,
               "of what curvature suggests", f * standard_.u_interpolation(g) / standard_.shape(g));
  }

  void add_zeros() {
    const AngleModel& angles = instrument_.angles;
    const std::array<Angle, kDirectionAxes> u = {angles.u_zero_theta_i, angles.u_zero_theta_r, angles.u_zero_phi_r};
    for (std::size_t a = 0; a < kDirectionAxes; ++a) {
      const auto axis = static_cast<std::int64_t>(a);
      const double slope = slopes_.slope[a] - p_.value * reference_slope(a);
      add_shared({ComponentSource::Zero, axis, 0, 0}, fmt::format("zero {}", kAxisNames[a]), in_degrees(u[a]), "deg",
                 slope * u[a].si());
      add_shared({ComponentSource::UnresolvedSlope, axis, 0, 0},
                 fmt::format("zero {} through unresolved slopes", kAxisNames[a]), in_degrees(u[a]), "deg",
                 slopes_.unresolved[a] * u[a].si());
    }
  }

  void add_detector() {
    const DetectorModel& d = instrument_.detector;
    add_shared({ComponentSource::ExposureOffset, 0, 0, 0}, "exposure offset", d.exposure_offset_s.u, "s",
               p_.value * (p_.sample.dlnq_dt0 - p_.reference.dlnq_dt0) * d.exposure_offset_s.u);
    add_shared({ComponentSource::Linearity, 0, 0, 0}, "linearity", d.u_linearity, "1",
               p_.value * (p_.sample.mean_net_dn - p_.reference.mean_net_dn) / d.full_scale_dn * d.u_linearity);
  }

  void add_lamp() {
    const LampModel& lamp = instrument_.lamp;
    const double apart = in_seconds(p_.reference.at - p_.sample.at) / lamp.correlation_s;
    const double middle =
        0.5 * (in_seconds(p_.reference.at.time_since_epoch()) + in_seconds(p_.sample.at.time_since_epoch()));
    const auto interval = static_cast<std::int64_t>(std::floor(middle / lamp.correlation_s));
    const double u = lamp.u_after_monitor * std::sqrt(-std::expm1(-0.5 * apart * apart));
    add_shared({ComponentSource::Lamp, interval, 0, 0},
               fmt::format("lamp after the monitor, {:.0f} s", static_cast<double>(interval) * lamp.correlation_s),
               lamp.u_after_monitor, "1", p_.value * u);
  }

  // The response at two moments, as its visits found it: what both moments have of one visit cancels.
  void add_drift() {
    if (!p_.sample_drift || !p_.reference_drift) return;
    const DriftLevel& sample = *p_.sample_drift;
    const DriftLevel& reference = *p_.reference_drift;
    std::map<std::int64_t, std::pair<const ReferenceVisit*, double>> visits;
    const auto add_visit = [&visits](const ReferenceVisit* visit, double weight) {
      if (visit == nullptr) return;
      auto& entry = visits.try_emplace(visit->visit_id, visit, 0.0).first->second;
      entry.second += weight;
    };
    add_visit(reference.before, (1.0 - reference.weight_after) / reference.level);
    add_visit(reference.after, reference.weight_after / reference.level);
    add_visit(sample.before, -(1.0 - sample.weight_after) / sample.level);
    add_visit(sample.after, -sample.weight_after / sample.level);
    for (const auto& [id, visit] : visits) {
      add_shared({ComponentSource::VisitNoise, id, 0, 0}, fmt::format("reference visit {}", id), visit.first->u, "1",
                 p_.value * visit.second * visit.first->u);
    }
    const bool is_same = sample.before == reference.before && sample.after == reference.after;
    if (!is_same) {
      add_change(sample, sample.weight_after, sample.beyond);
      add_change(reference, reference.weight_after, reference.beyond);
    } else {
      add_change(sample, std::abs(sample.weight_after - reference.weight_after),
                 std::abs(sample.beyond - reference.beyond));
    }
  }

  // Between two visits the straight line is wrong by as much as a step at an unknown moment makes it: change
  // sqrt(p (1 - p)) over the part p of the interval. Beyond the visits the change may have gone on.
  void add_change(const DriftLevel& at, double part, double beyond) {
    const double u = at.change / at.level * (at.is_between() ? std::sqrt(part * (1.0 - part)) : beyond);
    const std::int64_t before = at.before == nullptr ? -1 : at.before->visit_id;
    const std::int64_t after = at.after == nullptr ? -1 : at.after->visit_id;
    add_shared({ComponentSource::Drift, before, after, 0}, fmt::format("drift between visits {} and {}", before, after),
               at.change, "1", p_.value * u);
  }

  // One range's gain cancels between two readings in it; each other one stays.
  void add_ranges() {
    const auto& power = instrument_.detector.power;
    if (!power) return;
    std::map<std::int64_t, double> parts;
    for (const DarkShare& share : p_.sample.darks) parts[share.rung.range_pw] += p_.value;
    for (const DarkShare& share : p_.reference.darks) parts[share.rung.range_pw] -= p_.value;
    for (const auto& [range_pw, part] : parts) {
      if (part == 0.0) continue;
      add_shared({ComponentSource::Range, range_pw, 0, 0}, "gain of the range of " + range_text(range_pw),
                 power->u_range, "1", part * power->u_range);
    }
  }

  static std::string range_text(std::int64_t range_pw) {
    return fmt::format("{:g} W", static_cast<double>(range_pw) * 1e-12);
  }

  void add_darks(const NormalisedReading& reading, double dvalue_dq) {
    for (const DarkShare& share : reading.darks) {
      const double per_dn = dvalue_dq * share.dq_dlevel;
      add_dark_visit(share, share.level.before, per_dn * (1.0 - share.level.weight_after));
      add_dark_visit(share, share.level.after, per_dn * share.level.weight_after);
      add_dark_drift(share, per_dn * share.level.drift_widening);
    }
  }

  void add_dark_drift(const DarkShare& share, double per_dn) {
    const std::int64_t before = share.level.before == nullptr ? -1 : share.level.before->visit_id;
    const std::int64_t after = share.level.after == nullptr ? -1 : share.level.after->visit_id;
    if (const auto& power = instrument_.detector.power) {
      const double u = power->u_zero * static_cast<double>(share.rung.range_pw) * 1e-12;
      add_shared({ComponentSource::DarkDrift, before, after, share.rung.range_pw},
                 fmt::format("zero {} to {} in the range of {}", before, after, range_text(share.rung.range_pw)), u,
                 "W", per_dn * u);
      return;
    }
    const double drift = instrument_.detector.u_dark_drift_dn_per_s;
    const double exposure_s = static_cast<double>(share.rung.exposure_us) * 1e-6;
    add_shared({ComponentSource::DarkDrift, before, after, 0}, fmt::format("dark drift {} to {}", before, after), drift,
               "DN/s", per_dn * drift * exposure_s);
  }

  void add_dark_visit(const DarkShare& share, const DarkVisit* visit, double per_dn) {
    if (visit == nullptr) return;
    const bool is_power = share.rung.range_pw != 0;
    add_shared({ComponentSource::DarkNoise, visit->visit_id, is_power ? share.rung.range_pw : share.rung.exposure_us,
                share.rung.gain_mdb},
               is_power
                   ? fmt::format("dark visit {} in the range of {}", visit->visit_id, range_text(share.rung.range_pw))
                   : fmt::format("dark visit {} at {} us", visit->visit_id, share.rung.exposure_us),
               visit->u_dn, is_power ? "W" : "DN", per_dn * visit->u_dn);
  }

  const PairedPoint& p_;
  const DirectionSlopes& slopes_;
  const InstrumentModel& instrument_;
  const ReferenceStandard& standard_;
  ComponentTable& table_;
  std::vector<BudgetTerm> random_;
  std::vector<BudgetTerm> shared_;
};

}  // namespace

Brdf scatter(const PairedPoint& p, const InstrumentModel& instrument) {
  const double sample = p.dvalue_dq * std::hypot(p.sample.u_noise, p.sample.u_monitor);
  const double reference = p.value * std::hypot(p.reference.u_noise, p.reference.u_monitor) / p.reference.q;
  const double placing = p.value * instrument.lamp.u_reproducibility;
  return per_steradian(std::sqrt(sample * sample + reference * reference + 2.0 * placing * placing));
}

Budget point_budget(const PairedPoint& point, const DirectionSlopes& slopes, const InstrumentModel& instrument,
                    const ReferenceStandard& standard, ComponentTable& table) {
  return Terms(point, slopes, instrument, standard, table).budget();
}

}  // namespace gonio::calibration
