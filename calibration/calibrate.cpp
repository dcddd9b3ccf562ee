#include "calibration/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "calibration/component_table.h"
#include "calibration/dark_history.h"
#include "calibration/direction_slopes.h"
#include "calibration/drift_history.h"
#include "calibration/normalised_reading.h"
#include "calibration/point_budget.h"

namespace gonio::calibration {
namespace {

struct Readings {
  const RawReading* sample = nullptr;
  const RawReading* reference = nullptr;
};

/// Where the standard, which is isotropic, gives the same reading: wavelength, thetas, |dphi|.
using StandardPlace = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

StandardPlace place_of(const PlannedPoint& point) {
  const auto key = [](Angle a) { return std::llround(in_degrees(a) * 1e3); };
  const Geometry& g = point.geometry;
  const std::int64_t dphi = std::abs(key(wrapped(g.phi_r - g.phi_i)));
  const bool at_pole = key(g.theta_i) == 0 || key(g.theta_r) == 0;
  return {std::llround(in_nanometres(point.wavelength) * 1e3), key(g.theta_i), key(g.theta_r), at_pole ? 0 : dphi};
}

/// Which readings make which point.
class Pairing {
 public:
  explicit Pairing(const ScanReadings& scan) {
    for (const RawReading& reading : scan.readings) {
      if (!reading.point_index || reading.target == Target::Dark) continue;
      Readings& readings = by_point_[*reading.point_index];
      (reading.target == Target::Sample ? readings.sample : readings.reference) = &reading;
    }
    for (const PlannedPoint& point : scan.points) {
      if (const RawReading* own = of(point).reference) by_place_.try_emplace(place_of(point), own);
    }
    for (const PlannedPoint& point : scan.points) {
      if (of(point).sample == nullptr) continue;
      if (const RawReading* reference = reference_of(point)) ++uses_[reference->id];
    }
  }

  [[nodiscard]] Readings of(const PlannedPoint& point) const {
    const auto found = by_point_.find(point.index);
    return found == by_point_.end() ? Readings{} : found->second;
  }
  /// Its own, or another point's of the same place, or null.
  [[nodiscard]] const RawReading* reference_of(const PlannedPoint& point) const {
    if (const RawReading* own = of(point).reference) return own;
    const auto found = by_place_.find(place_of(point));
    return found == by_place_.end() ? nullptr : found->second;
  }
  [[nodiscard]] bool is_shared(std::int64_t reference_id) const { return uses_.at(reference_id) > 1; }

 private:
  std::map<std::int32_t, Readings> by_point_;
  std::map<StandardPlace, const RawReading*> by_place_;
  std::map<std::int64_t, int> uses_;
};

Error no_ratio(const PlannedPoint& point, std::string seen, std::string limit) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = fmt::format("calibrate point {}", point.index),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

/// What all readings of a scan are seen by.
struct Histories {
  DarkHistory darks;
  std::optional<DriftHistory> drift;
};

Result<PairedPoint> make_pair(const PlannedPoint& point, const RawReading& sample, const RawReading& reference,
                              const Histories& histories, const DetectorModel& detector,
                              const ReferenceStandard& standard) {
  const DarkHistory& darks = histories.darks;
  auto q_sample = normalise(sample, darks, detector);
  if (!q_sample) return failure(std::move(q_sample).error());
  auto q_reference = normalise(reference, darks, detector);
  if (!q_reference) return failure(std::move(q_reference).error());
  const Geometry& at = q_reference->geometry;
  GONIO_TRY(standard.check_reach(point.wavelength, at));
  if (!(q_reference->q > 0.0)) {
    return failure(no_ratio(point,
                            fmt::format("reference reading {} of {:.4g} {} net", reference.id, q_reference->mean_net_dn,
                                        detector.power ? "of its range" : "DN"),
                            "more than 0"));
  }
  PairedPoint pair{.sample = std::move(*q_sample),
                   .reference = std::move(*q_reference),
                   .reference_id = reference.id,
                   .wavelength = point.wavelength,
                   .rho = standard.reflectance(point.wavelength).value()};
  pair.cosine_ratio = std::cos(pair.reference.geometry.theta_i.si()) / std::cos(pair.sample.geometry.theta_i.si());
  if (histories.drift) {
    pair.sample_drift = histories.drift->at(pair.sample.at);
    pair.reference_drift = histories.drift->at(pair.reference.at);
  }
  if (pair.sample_drift) pair.drift_ratio = pair.reference_drift->level / pair.sample_drift->level;
  const double f_ref = pair.rho.value * standard.shape(pair.reference.geometry) / std::numbers::pi;
  pair.dvalue_dq = f_ref * pair.cosine_ratio * pair.drift_ratio / pair.reference.q;
  pair.value = pair.dvalue_dq * pair.sample.q;
  return pair;
}

std::uint32_t flags_of(const PairedPoint& pair, const Budget& budget, const DirectionSlopes& slopes, bool borrowed) {
  std::uint32_t flags = 0;
  const auto set = [&](PointFlag flag, bool on) { flags |= on ? static_cast<std::uint32_t>(flag) : 0U; };
  const auto extrapolated = [](const NormalisedReading& reading) {
    return std::ranges::any_of(reading.darks, [](const DarkShare& d) { return d.level.is_extrapolated(); });
  };
  const auto drifted = [](const std::optional<DriftLevel>& drift) { return drift && drift->is_large; };
  constexpr double kLinearUpTo = 0.05;
  set(PointFlag::NearZero, std::abs(pair.value) <= budget.expanded.si());
  set(PointFlag::DarkExtrapolated, extrapolated(pair.sample) || extrapolated(pair.reference));
  set(PointFlag::FewNeighbours, !std::ranges::all_of(slopes.has_neighbours, std::identity{}));
  set(PointFlag::BorrowedReference, borrowed);
  set(PointFlag::Drifted, drifted(pair.sample_drift) || drifted(pair.reference_drift));
  set(PointFlag::UncertainDivisor,
      std::hypot(pair.reference.u_noise, pair.reference.u_monitor) > kLinearUpTo * pair.reference.q);
  return flags;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

ScanSummary summarise(const CalibratedScan& scan, const std::vector<PairedPoint>& pairs) {
  ScanSummary summary{.points = scan.points.size(), .refused = scan.refused.size()};
  std::vector<double> absolute;
  std::vector<double> relative;
  for (const CalibratedPoint& point : scan.points) {
    absolute.push_back(point.budget.expanded.si());
    if (has(point.flags, PointFlag::NearZero))
      ++summary.near_zero;
    else
      relative.push_back(point.budget.expanded.si() / std::abs(point.value.si()));
  }
  double chi2 = 0.0;
  double dof = 0.0;
  for (const PairedPoint& pair : pairs) {
    chi2 += pair.sample.frame_chi2 + pair.reference.frame_chi2;
    dof += pair.sample.frame_dof + pair.reference.frame_dof;
  }
  summary.median_relative_expanded = median(relative);
  summary.worst_relative_expanded = relative.empty() ? 0.0 : std::ranges::max(relative);
  summary.median_expanded = per_steradian(median(std::move(absolute)));
  summary.frame_chi2_per_dof = dof > 0.0 ? chi2 / dof : 0.0;
  return summary;
}

/// The scan on its way: points that have a pair of readings, and what is made of them.
struct Draft {
  std::vector<PairedPoint> pairs;
  std::vector<CalibratedPoint> points;  ///< as many
  std::vector<bool> borrowed;           ///< as many
  std::vector<SlopePoint> places;       ///< as many
  std::vector<RefusedPoint> refused;
};

void add_point(Draft& draft, const PlannedPoint& point, const Pairing& pairing, const Histories& histories,
               const InstrumentModel& instrument, const ReferenceStandard& standard) {
  const Readings own = pairing.of(point);
  if (own.sample == nullptr) return;
  const RawReading* reference = pairing.reference_of(point);
  if (reference == nullptr) {
    draft.refused.push_back(
        {point.index, no_ratio(point, "no reference reading", "one at the same geometry and wavelength")});
    return;
  }
  auto pair = make_pair(point, *own.sample, *reference, histories, instrument.detector, standard);
  if (!pair) {
    draft.refused.push_back({point.index, std::move(pair).error()});
    return;
  }
  pair->reference_is_shared = pairing.is_shared(reference->id);
  draft.points.push_back({.point_index = point.index,
                          .geometry = pair->sample.geometry,
                          .wavelength = point.wavelength,
                          .value = per_steradian(pair->value),
                          .sample_reading = own.sample->id,
                          .reference_reading = reference->id});
  draft.borrowed.push_back(reference != own.reference);
  draft.places.push_back({.planned = point.geometry,
                          .reported = pair->sample.geometry,
                          .wavelength = point.wavelength,
                          .value = per_steradian(pair->value),
                          .u_random = scatter(*pair, instrument)});
  draft.pairs.push_back(std::move(*pair));
}

}  // namespace

std::string_view flag_name(PointFlag flag) {
  switch (flag) {
    case PointFlag::NearZero:
      return "near-zero";
    case PointFlag::DarkExtrapolated:
      return "dark-extrapolated";
    case PointFlag::FewNeighbours:
      return "few-neighbours";
    case PointFlag::BorrowedReference:
      return "borrowed-reference";
    case PointFlag::UncertainDivisor:
      return "uncertain-divisor";
    case PointFlag::Drifted:
      return "drifted";
    case PointFlag::InstrumentLimited:
      return "instrument-limited";
    case PointFlag::MonteCarlo:
      return "monte-carlo";
    case PointFlag::FewRepeats:
      return "few-repeats";
    case PointFlag::Mixed:
      return "mixed";
    case PointFlag::ReferenceExtrapolated:
      return "reference-extrapolated";
    case PointFlag::Blocked:
      return "blocked";
    case PointFlag::Saturated:
      return "saturated";
  }
  return "";
}

Result<CalibratedScan> calibrate(const ScanReadings& scan, const InstrumentModel& instrument,
                                 const ReferenceStandard& standard, UtcTime measured_on,
                                 const CalibrationOptions& options) {
  GONIO_TRY(standard.check_date(measured_on));
  Histories histories{.darks = DarkHistory(scan, instrument.detector), .drift = std::nullopt};
  if (options.correct_drift) histories.drift.emplace(scan, histories.darks, instrument);
  const Pairing pairing(scan);
  Draft draft;
  for (const PlannedPoint& point : scan.points) add_point(draft, point, pairing, histories, instrument, standard);
  const std::vector<DirectionSlopes> slopes = direction_slopes(draft.places, scan.isotropic);
  ComponentTable table;
  for (std::size_t n = 0; n < draft.points.size(); ++n) {
    CalibratedPoint& point = draft.points[n];
    point.budget = point_budget(draft.pairs[n], slopes[n], instrument, standard, table);
    point.flags = flags_of(draft.pairs[n], point.budget, slopes[n], draft.borrowed[n]);
  }
  CalibratedScan calibrated{
      .components = table.components(), .points = std::move(draft.points), .refused = std::move(draft.refused)};
  calibrated.summary = summarise(calibrated, draft.pairs);
  return calibrated;
}

std::string describe_inputs(const InstrumentModel& instrument, const ReferenceStandard& standard,
                            const CalibrationOptions& options) {
  const DetectorModel& d = instrument.detector;
  const AngleModel& a = instrument.angles;
  const LampModel& l = instrument.lamp;
  const Certificate& c = standard.certificate();
  std::string text = fmt::format("{}\n", kCalibrationCode);
  if (!options.correct_drift) text += "drift uncorrected\n";
  const auto line = [&](std::string_view name, std::initializer_list<double> values) {
    text += name;
    for (const double value : values) text += fmt::format(" {:.17g}", value);
    text += '\n';
  };
  line("detector", {d.electrons_per_dn, d.read_noise_dn, d.full_scale_dn, d.exposure_offset_s.value,
                    d.exposure_offset_s.u, d.u_linearity, d.u_dark_drift_dn_per_s});
  if (d.u_monitor_window > 0.0) line("monitor", {d.u_monitor_window});
  if (d.power) line("radiometer", {d.power->noise, d.power->u_range, d.power->u_zero});
  line("angles", {a.u_zero_theta_i.si(), a.u_zero_theta_r.si(), a.u_zero_phi_r.si(), a.u_repeat.si()});
  line("lamp", {l.u_after_monitor, l.correlation_s, l.u_reproducibility, l.reproducibility_dof});
  text += fmt::format("standard {} {} {}\n", standard.serial(), c.date, c.expires);
  line("certificate", {static_cast<double>(c.geometry), c.specular_port.value_or(Angle{}).si(), c.coverage_factor,
                       c.longest_gap.si()});
  for (const CertificateEntry& e : c.entries) line("entry", {e.wavelength.si(), e.reflectance, e.u});
  const ShapeTable& table = standard.table();
  for (const auto* grid : {&table.theta_i(), &table.theta_r(), &table.phi()}) {
    text += "grid";
    for (const Angle angle : *grid) text += fmt::format(" {:.17g}", angle.si());
    text += "\n";
  }
  text += "values";
  for (const double value : table.values()) text += fmt::format(" {:.17g}", value);
  text += '\n';
  for (const ShapeMode& m : standard.modes()) line("mode " + m.name, {static_cast<double>(m.kind), m.u, m.width.si()});
  line("integral", {standard.u_integral()});
  return text;
}

}  // namespace gonio::calibration
