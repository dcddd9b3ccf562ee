#include "calibration/jobs/arm_zeros.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "calibration/dark_history.h"
#include "calibration/jobs/least_squares.h"
#include "calibration/normalised_reading.h"

namespace gonio::calibration {

namespace {

constexpr Angle kSame = degrees(1e-3);  // planned angles that are one
constexpr std::size_t kLeastPlaces = 3;

// A crossing of the lobe: at which theta_i, along which angle, and for the normal's at which azimuth.
struct Crossing {
  enum class Along : std::uint8_t { ThetaR, PhiR, Normal };
  Along along = Along::ThetaR;
  Angle theta_i;
  Angle phi_r;
  friend auto operator<=>(const Crossing&, const Crossing&) = default;
};

struct LobePoint {
  double x = 0.0;  // rad, by the encoder
  double ln_q = 0.0;
  double u = 0.0;        // of ln q
  double theta_i = 0.0;  // rad, by the encoder
};

struct Centre {
  Crossing of;
  double x = 0.0;  // rad
  double u = 0.0;
  double theta_i = 0.0;  // rad, mean of the encoder
  double width = 0.0;    // rad, the lobe's standard deviation
};

bool is_same(Angle a, Angle b) {
  return std::abs(in_radians(a - b)) < in_radians(kSame);
}

// A point in the middle lies on two crossings.
std::vector<Crossing> crossings_of(const Geometry& g) {
  if (is_same(g.theta_i, degrees(0.0))) {
    return {{.along = Crossing::Along::Normal, .theta_i = degrees(0.0), .phi_r = g.phi_r}};
  }
  std::vector<Crossing> crossings;
  if (is_same(wrapped(g.phi_r - degrees(180.0)), degrees(0.0))) {
    crossings.push_back({.along = Crossing::Along::ThetaR, .theta_i = g.theta_i, .phi_r = {}});
  }
  if (is_same(g.theta_r, g.theta_i)) {
    crossings.push_back({.along = Crossing::Along::PhiR, .theta_i = g.theta_i, .phi_r = {}});
  }
  return crossings;
}

using Lines = std::map<Crossing, std::vector<LobePoint>>;

Lines lines_of(const ScanReadings& scan, const InstrumentModel& instrument) {
  const DarkHistory darks(scan, instrument.detector);
  std::map<std::int32_t, Geometry> planned;
  for (const PlannedPoint& point : scan.points) planned[point.index] = point.geometry;
  Lines lines;
  for (const RawReading& reading : scan.readings) {
    if (reading.target != Target::Sample || !reading.point_index) continue;
    const Result<NormalisedReading> q = normalise(reading, darks, instrument.detector);
    if (!q || !(q->q > 0.0)) continue;
    const double u = std::hypot(std::hypot(q->u_noise, q->u_monitor) / q->q, instrument.lamp.u_reproducibility);
    for (const Crossing& crossing : crossings_of(planned[*reading.point_index])) {
      const bool is_phi = crossing.along == Crossing::Along::PhiR;
      lines[crossing].push_back({.x = in_radians(is_phi ? q->geometry.phi_r : q->geometry.theta_r),
                                 .ln_q = std::log(q->q),
                                 .u = u,
                                 .theta_i = in_radians(q->geometry.theta_i)});
    }
  }
  return lines;
}

struct Parabola {  // of x from `middle`
  double middle = 0.0;
  std::array<double, 3> c{};
  std::array<double, 9> covariance{};
  double chi2 = 0.0;
};

// `u_repeat`: of the angle, which tells through the slope of the parabola before.
std::optional<Parabola> parabola_through(const std::vector<LobePoint>& points, double middle, const Parabola& before,
                                         double u_repeat) {
  constexpr std::array<std::size_t, 3> kPlaces{0, 1, 2};
  LeastSquares squares(3);
  for (const LobePoint& point : points) {
    const double x = point.x - middle;
    const double slope = before.c[1] + 2.0 * before.c[2] * (point.x - before.middle);
    const double u = std::hypot(point.u, slope * u_repeat);
    const std::array<double, 3> row{1.0 / u, x / u, x * x / u};
    squares.add(point.ln_q / u, kPlaces, row);
  }
  const Result<LeastSquares::Step> step = squares.solve();
  if (!step) return std::nullopt;
  Parabola found{.middle = middle, .chi2 = squares.sum_of_squares()};
  std::copy_n(step->change.begin(), 3, found.c.begin());
  std::copy_n(step->covariance.begin(), 9, found.covariance.begin());
  return found;
}

// The centre, from the part of the lobe above a twentieth of its highest point; none when it does not bend down.
std::optional<Centre> centre_of(const Crossing& crossing, std::vector<LobePoint> points, double u_repeat) {
  constexpr double kDeepest = 3.0;  // ln 20
  if (points.empty()) return std::nullopt;
  std::ranges::sort(points, std::ranges::greater(), &LobePoint::ln_q);
  const LobePoint top = points.front();
  // Five at least, where they stand clear of the noise.
  constexpr std::ptrdiff_t kLeastPoints = 5;
  constexpr double kNoise = 0.1;
  const auto is_low = [&](const LobePoint& p) { return p.ln_q < top.ln_q - kDeepest; };
  const auto tail = points.begin() + std::min(kLeastPoints, std::ssize(points));
  points.erase(std::remove_if(tail, points.end(), is_low), points.end());
  std::erase_if(points, [](const LobePoint& p) { return p.u > kNoise; });
  if (std::ssize(points) < kLeastPoints - 1) return std::nullopt;
  std::optional<Parabola> line = parabola_through(points, top.x, {}, 0.0);
  for (int round = 0; round < 3 && line; ++round) line = parabola_through(points, top.x, *line, u_repeat);
  if (!line || !(line->c[2] < 0.0)) return std::nullopt;
  const double at = -line->c[1] / (2.0 * line->c[2]);
  const double by_1 = -1.0 / (2.0 * line->c[2]);
  const double by_2 = -at / line->c[2];
  const auto& v = line->covariance;
  double theta_i = 0.0;
  for (const LobePoint& p : points) theta_i += p.theta_i / static_cast<double>(points.size());
  return Centre{.of = crossing,
                .x = line->middle + at,
                .u = std::sqrt(by_1 * by_1 * v[4] + 2.0 * by_1 * by_2 * v[5] + by_2 * by_2 * v[8]),
                .theta_i = theta_i,
                .width = 1.0 / std::sqrt(-2.0 * line->c[2])};
}

enum Place : std::size_t { kThetaI, kThetaR, kPhiR, kLean, kAcross, kParameters };

struct Row {
  double seen = 0.0;
  std::array<double, kParameters> slopes{};
  double u = 0.0;
};

Row row_of(const Centre& centre) {
  Row row{.u = centre.u};
  switch (centre.of.along) {
    case Crossing::Along::ThetaR: {
      row.seen = centre.x - centre.theta_i;
      row.slopes = {1.0, -1.0, 0.0, -2.0, 0.0};
      // A rough mirror's lobe leans towards grazing by the square of its width: not corrected.
      row.u = std::hypot(centre.u, centre.width * centre.width * std::tan(centre.theta_i));
      break;
    }
    case Crossing::Along::PhiR:
      row.seen = in_radians(wrapped(radians(centre.x) - degrees(180.0)));
      row.slopes = {0.0, 0.0, -1.0, 0.0, -1.0 / std::tan(centre.theta_i)};
      break;
    case Crossing::Along::Normal: {
      const double cosine = std::cos(in_radians(centre.of.phi_r));
      row.seen = centre.x;
      row.slopes = {-cosine, -1.0, 0.0, 2.0 * cosine, std::sin(in_radians(centre.of.phi_r))};
      break;
    }
  }
  return row;
}

struct Solution {
  std::vector<double> values;
  std::vector<double> covariance;
  double chi2 = 0.0;  // of the crossings alone
};

// How far each zero may be. Crossings tell that of phi_r alone, and the others where the normal was crossed; else their
// difference only, and what instrument.toml states stands for their sum: more, where the difference belies it.
std::array<Angle, 4> priors(const std::vector<Row>& rows, bool crosses_normal, const AngleModel& angles,
                            Angle u_mirror) {
  constexpr Angle kAnywhere = degrees(30.0);
  if (crosses_normal) return {kAnywhere, kAnywhere, kAnywhere, u_mirror};
  constexpr double kBelied = 2.0;  // standard deviations
  double difference = 0.0;
  for (const Row& row : rows) {
    if (row.slopes[kLean] != 0.0) difference = std::max(difference, std::abs(row.seen));
  }
  const double stated = std::hypot(in_radians(angles.u_zero_theta_i), in_radians(angles.u_zero_theta_r));
  const bool is_belied = difference > kBelied * stated;
  const Angle half = radians(0.5 * difference);
  return {is_belied ? std::max(half, angles.u_zero_theta_i) : angles.u_zero_theta_i,
          is_belied ? std::max(half, angles.u_zero_theta_r) : angles.u_zero_theta_r, kAnywhere, u_mirror};
}

Result<Solution> solve(const std::vector<Row>& rows, const std::array<Angle, 4>& prior) {
  constexpr double kSurelyKnown = 1e-9;  // rad
  constexpr std::array<std::size_t, kParameters> kPlaces{kThetaI, kThetaR, kPhiR, kLean, kAcross};
  LeastSquares squares(kParameters);
  for (const Row& row : rows) {
    std::array<double, kParameters> slopes{};
    std::ranges::transform(row.slopes, slopes.begin(), [&](double slope) { return slope / row.u; });
    squares.add(row.seen / row.u, kPlaces, slopes);
  }
  for (std::size_t place = 0; place < prior.size(); ++place) {
    const double slope = 1.0 / std::max(kSurelyKnown, in_radians(prior[place]));
    squares.add(0.0, std::span(&place, 1), std::span(&slope, 1));
  }
  const Result<LeastSquares::Step> step = squares.solve();
  if (!step) return failure(step.error());
  Solution solution{.values = step->change, .covariance = step->covariance};
  for (const Row& row : rows) {
    double left = row.seen;
    for (std::size_t k = 0; k < kParameters; ++k) left -= row.slopes[k] * solution.values[k];
    solution.chi2 += left * left / (row.u * row.u);
  }
  return solution;
}

struct Crossings {
  std::vector<Row> rows;
  std::size_t places = 0;  // theta_i with both
  std::size_t across_normal = 0;
  std::string without_peak;  // the crossings that had none, in words
};

std::string words_of(const Crossing& crossing, std::size_t points) {
  const double theta_i = in_degrees(crossing.theta_i);
  if (crossing.along == Crossing::Along::Normal) {
    return fmt::format("across the normal at azimuth {:.0f} deg ({} points)", in_degrees(crossing.phi_r), points);
  }
  return fmt::format("along {} at theta_i {:.1f} deg ({} points)",
                     crossing.along == Crossing::Along::ThetaR ? "theta_r" : "phi_r", theta_i, points);
}

Crossings measured_crossings(const ScanReadings& scan, const InstrumentModel& instrument) {
  Crossings all;
  std::map<Angle, int> at;
  for (auto& [crossing, points] : lines_of(scan, instrument)) {
    // Two axes lie between lamp and detector in every direction. One of the two may stand still along a crossing: then
    // it has one error there, which no number of points makes smaller.
    const double u_repeat = in_radians(instrument.angles.u_repeat);
    std::optional<Centre> centre = centre_of(crossing, points, std::numbers::sqrt2 * u_repeat);
    if (!centre) {
      all.without_peak += (all.without_peak.empty() ? "" : ", ") + words_of(crossing, points.size());
      continue;
    }
    centre->u = std::hypot(centre->u, u_repeat);
    all.rows.push_back(row_of(*centre));
    if (crossing.along == Crossing::Along::Normal) {
      ++all.across_normal;
    } else if (++at[crossing.theta_i] == 2) {
      ++all.places;
    }
  }
  return all;
}

// What its mounting did across the plane of incidence it may have done in the plane, where no angle tells.
std::string lean_words(const Solution& solution, double widening, Angle u_mirror) {
  constexpr double kBelied = 2.0;  // standard deviations
  const Angle lean = radians(0.5 * solution.values[kAcross]);
  const Angle u = radians(0.5 * std::sqrt(widening * solution.covariance[kAcross * kParameters + kAcross]));
  const bool is_belied = std::abs(in_radians(lean)) > kBelied * std::hypot(in_radians(u), in_radians(u_mirror));
  return fmt::format("; the mirror leans {:.4f} deg across the plane of incidence, u = {:.4f} deg{}", in_degrees(lean),
                     in_degrees(u), is_belied ? ": more than u_mirror_deg says of the lean in the plane" : "");
}

}  // namespace

Result<FoundValues> fit_arm_zeros(const ScanReadings& scan, const InstrumentModel& instrument,
                                  const ArmZeroOptions& options) {
  const Crossings crossings = measured_crossings(scan, instrument);
  if (crossings.places < kLeastPlaces) {
    return failure(
        {.code = ErrorCode::IncompleteData,
         .device = "mirror",
         .tried = "fit the zeros of the arms",
         .seen = fmt::format("the mirror's lobe was crossed both ways at {} theta_i; without a peak: {}",
                             crossings.places, crossings.without_peak.empty() ? "none" : crossings.without_peak),
         .limit = "three at least, with the peak inside of both crossings"});
  }
  const bool crosses_normal = crossings.across_normal >= kLeastPlaces;
  const Result<Solution> solution =
      solve(crossings.rows, priors(crossings.rows, crosses_normal, instrument.angles, options.u_mirror));
  if (!solution) return failure(solution.error());
  const double dof = static_cast<double>(crossings.rows.size()) - (crosses_normal ? 4.0 : 3.0);
  const double ratio = dof > 0.0 ? solution->chi2 / dof : 1.0;
  FoundValues found;
  const double widening = std::max(1.0, ratio);
  const std::array<const char*, 3> names{"zero_theta_i_deg", "zero_theta_r_deg", "zero_phi_r_deg"};
  const double degree = in_degrees(radians(1.0));
  for (std::size_t a = 0; a < names.size(); ++a) {
    found.values.push_back({.name = names[a], .unit = "deg", .value = degree * solution->values[a]});
    for (std::size_t b = 0; b < names.size(); ++b) {
      found.covariance.push_back(degree * degree * widening * solution->covariance[a * kParameters + b]);
    }
  }
  found.note = fmt::format(
      "{} crossings of the mirror's lobe, {} of them across the normal; chi-square {:.2f} a degree of freedom{}{}",
      crossings.rows.size(), crossings.across_normal, ratio, lean_words(*solution, widening, options.u_mirror),
      crosses_normal ? ""
                     : "; theta_i and theta_r are known by their difference: their sum is as uncertain as "
                       "instrument.toml states");
  return found;
}

}  // namespace gonio::calibration
