#include "calibration/history_terms.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "calibration/drift_bridge.h"

namespace gonio::calibration {
namespace {

using Source = ComponentSource;

std::string range_text(std::int64_t range_pw) {
  return fmt::format("{:g} W", static_cast<double>(range_pw) * 1e-12);
}

template <class Visit>
std::int64_t id_of(const Visit* visit) {
  return visit == nullptr ? -1 : visit->visit_id;
}

// The response at two moments, as its visits found it: what both moments have of one visit cancels, for the terms of
// one component add with their signs.
class DriftTerms {
 public:
  DriftTerms(const PairedPoint& p, TermList& terms) : p_(p), terms_(terms) {}

  void add() {
    if (!p_.sample_drift || !p_.reference_drift) return;
    const DriftLevel& sample = *p_.sample_drift;
    const DriftLevel& reference = *p_.reference_drift;
    add_visit(reference.before, (1.0 - reference.weight_after) / reference.level);
    add_visit(reference.after, reference.weight_after / reference.level);
    add_visit(sample.before, -(1.0 - sample.weight_after) / sample.level);
    add_visit(sample.after, -sample.weight_after / sample.level);
    if (sample.wander == 0.0 && reference.wander == 0.0 && sample.is_between() && reference.is_between()) return;
    const bool is_same = sample.before == reference.before && sample.after == reference.after;
    if (!is_same) {
      add_missed(sample, 1.0, bridge_at(sample.weight_after), sample.beyond);
      add_missed(reference, -1.0, bridge_at(reference.weight_after), reference.beyond);
    } else {
      add_missed(sample, -1.0, bridge_between(sample.weight_after, reference.weight_after),
                 std::abs(sample.beyond - reference.beyond));
    }
  }

 private:
  void add_visit(const ReferenceVisit* visit, double weight) {
    if (visit == nullptr) return;
    terms_.shared({Source::VisitNoise, visit->visit_id}, visit->u, "1", p_.value * weight * visit->u,
                  [&] { return fmt::format("reference visit {}", visit->visit_id); });
  }

  // What the line between two visits misses (drift_bridge.h). Beyond the visits the change may have gone on.
  void add_missed(const DriftLevel& at, double sign, const BridgeParts& bridge, double beyond) {
    const std::int64_t before = id_of(at.before);
    const std::int64_t after = id_of(at.after);
    const double scale = sign * p_.value / at.level;
    if (!at.is_between()) {
      const double onward = std::hypot(at.change * beyond, at.wander_dof < 1e9 ? at.wander * std::sqrt(beyond) : 0.0);
      terms_.shared({Source::Drift, before, after}, std::max(at.change, at.wander), "1", p_.value / at.level * onward,
                    [&] { return fmt::format("drift between visits {} and {}", before, after); },
                    {.degrees_of_freedom = at.wander_dof, .is_pattern_known = false});
      return;
    }
    for (std::size_t k = 0; k < kBridgeModes; ++k) {
      terms_.shared({Source::Drift, before, after, static_cast<std::int64_t>(k) + 1}, at.wander, "1",
                    scale * at.wander * bridge.mode[k],
                    [&] { return fmt::format("drift between visits {} and {}, course {}", before, after, k + 1); },
                    {.degrees_of_freedom = at.wander_dof, .is_of_the_wander = std::isfinite(at.wander_dof)});
    }
    if (at.wander == 0.0) return;
    terms_.random(Source::DriftRest, "drift from reading to reading", 0.0, "sr^-1", scale * at.wander * bridge.rest,
                  at.wander_dof);
  }

  const PairedPoint& p_;
  TermList& terms_;
};

// One gain or range cancels between two readings in it; each other one stays.
void add_gains(const PairedPoint& p, const DetectorModel& detector, TermList& terms) {
  const auto u_gain = [&](const ExposureRung& rung) {
    for (const GainFactor& gain : detector.gains) {
      if (std::llround(gain.gain_db * 1e3) == rung.gain_mdb) return gain.factor.u / gain.factor.value;
    }
    return 0.0;
  };
  const auto u_range = [&](const ExposureRung& rung) {
    for (const RangeFactor& range : detector.power->ranges) {
      if (std::llround(range.range_w * 1e12) == rung.range_pw) return range.factor.u / range.factor.value;
    }
    return detector.power->u_range;
  };
  const auto add = [&](const DarkShare& share, double part) {
    if (detector.power) {
      const double u = u_range(share.rung);
      terms.shared({Source::Range, share.rung.range_pw}, u, "1", part * share.light_share * u,
                   [&] { return "gain of the range of " + range_text(share.rung.range_pw); });
    } else if (!detector.gains.empty()) {
      const double u = u_gain(share.rung);
      terms.shared({Source::Gain, share.rung.gain_mdb}, u, "1", -part * share.light_share * u,
                   [&] { return fmt::format("gain of {:g} dB", static_cast<double>(share.rung.gain_mdb) * 1e-3); });
    }
  };
  for (const DarkShare& share : p.sample.darks) add(share, p.value);
  for (const DarkShare& share : p.reference.darks) add(share, -p.value);
}

class DarkTerms {
 public:
  /// `divisor`: the q that the reading divides by; 0 for any other.
  DarkTerms(const DetectorModel& detector, TermList& terms, double divisor)
      : detector_(detector), terms_(terms), per_divisor_(divisor == 0.0 ? 0.0 : 1.0 / divisor) {}

  void add(const std::vector<DarkShare>& shares, double dvalue_dq) {
    for (const DarkShare& share : shares) {
      const double per_dn = dvalue_dq * share.dq_dlevel;
      const double relative = share.dq_dlevel * per_divisor_;
      const double after = share.level.weight_after;
      add_visit(share, share.level.before, per_dn * (1.0 - after), relative * (1.0 - after));
      add_visit(share, share.level.after, per_dn * after, relative * after);
      add_drift(share, per_dn * share.level.drift_widening, relative * share.level.drift_widening);
    }
  }

 private:
  void add_drift(const DarkShare& share, double per_dn, double relative) {
    const std::int64_t before = id_of(share.level.before);
    const std::int64_t after = id_of(share.level.after);
    if (const auto& power = detector_.power) {
      const double u = power->u_zero * static_cast<double>(share.rung.range_pw) * 1e-12;
      terms_.shared({Source::DarkDrift, before, after, share.rung.range_pw}, u, "W", per_dn * u,
                    [&] {
                      return fmt::format("zero {} to {} in the range of {}", before, after,
                                         range_text(share.rung.range_pw));
                    },
                    {.is_pattern_known = false});
      divide(relative * u, u);
      return;
    }
    const double drift = detector_.u_dark_drift_dn_per_s;
    const double exposure_s = static_cast<double>(share.rung.exposure_us) * 1e-6;
    terms_.shared({Source::DarkDrift, before, after}, drift, "DN/s", per_dn * drift * exposure_s,
                  [&] { return fmt::format("dark drift {} to {}", before, after); }, {.is_pattern_known = false});
    divide(relative * drift * exposure_s, drift);
  }

  void add_visit(const DarkShare& share, const DarkVisit* visit, double per_dn, double relative) {
    if (visit == nullptr) return;
    const bool is_power = share.rung.range_pw != 0;
    terms_.shared({Source::DarkNoise, visit->visit_id, is_power ? share.rung.range_pw : share.rung.exposure_us,
                   share.rung.gain_mdb},
                  visit->u_dn, is_power ? "W" : "DN", per_dn * visit->u_dn, [&] {
                    return is_power ? fmt::format("dark visit {} in the range of {}", visit->visit_id,
                                                  range_text(share.rung.range_pw))
                                    : fmt::format("dark visit {} at {} us", visit->visit_id, share.rung.exposure_us);
                  });
    divide(relative * visit->u_dn, visit->u_dn);
  }

  void divide(double relative, double u) {
    if (relative != 0.0 && u != 0.0) terms_.last_shared_divides(relative);
  }

  const DetectorModel& detector_;
  TermList& terms_;
  double per_divisor_;
};

/// The background of both readings. A visit's own darks and ambient light are terms of the point as well: where they
/// are the reading's too, they add with their signs.
class BackgroundTerms {
 public:
  BackgroundTerms(const DetectorModel& detector, TermList& terms) : detector_(detector), terms_(terms) {}

  void add(const NormalisedReading& reading, double dvalue_dq) {
    if (reading.ambient) add_ambient(*reading.ambient, dvalue_dq * reading.dq_dambient);
    if (!reading.stray) return;
    for_visits(*reading.stray, [&](const BackgroundVisit& visit, double weight) {
      const double per_unit = -dvalue_dq * weight;
      terms_.shared({Source::StrayVisit, visit.visit_id}, visit.u, "of q", per_unit * visit.u,
                    [&] { return fmt::format("trap visit {}", visit.visit_id); });
      DarkTerms(detector_, terms_, 0.0).add(visit.darks, per_unit);
      if (visit.ambient) add_ambient(*visit.ambient, per_unit * visit.dq_dambient);
    });
  }

 private:
  template <class Work>
  static void for_visits(const BackgroundLevel& level, const Work& work) {
    if (level.before != nullptr) work(*level.before, 1.0 - level.weight_after);
    if (level.after != nullptr) work(*level.after, level.weight_after);
  }

  void add_ambient(const BackgroundLevel& level, double per_level) {
    for_visits(level, [&](const BackgroundVisit& visit, double weight) {
      const double per_unit = per_level * weight;
      terms_.shared({Source::AmbientVisit, visit.visit_id}, visit.u, detector_.power ? "W" : "DN/s", per_unit * visit.u,
                    [&] { return fmt::format("ambient visit {}", visit.visit_id); });
      DarkTerms(detector_, terms_, 0.0).add(visit.darks, per_unit);
    });
  }

  const DetectorModel& detector_;
  TermList& terms_;
};

}  // namespace

void add_history_terms(const PairedPoint& p, const InstrumentModel& instrument, TermList& terms) {
  const DetectorModel& detector = instrument.detector;
  const double by_reference = -p.value / p.reference.q;
  DriftTerms(p, terms).add();
  add_gains(p, detector, terms);
  DarkTerms(detector, terms, 0.0).add(p.sample.darks, p.dvalue_dq);
  DarkTerms(detector, terms, p.reference.q).add(p.reference.darks, by_reference);
  BackgroundTerms(detector, terms).add(p.sample, p.dvalue_dq);
  BackgroundTerms(detector, terms).add(p.reference, by_reference);
}

}  // namespace gonio::calibration
