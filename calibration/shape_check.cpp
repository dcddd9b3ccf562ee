#include "calibration/shape_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calibration/cosine_weights.h"

namespace gonio::calibration {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDigitsOfATable = 1e-3;
constexpr double kPercent = 100.0;
constexpr double kExpanded = 2.0;  // times u: beyond it the table contradicts itself
// What tables of white standards return too much at 60 to 75 deg without being wrong by as much anywhere that is used.
constexpr double kExcessOfTables = 0.05;

double square_of(double x) {
  return x * x;
}

// Over 0 to 90 deg; beyond the last node its value stays.
std::vector<double> hemisphere_weights(const std::vector<Angle>& grid) {
  std::vector<double> weights = cosine_weights(grid);
  weights.back() += 0.5 * square_of(std::cos(grid.back().si()));
  return weights;
}

// Trapezoids over 0 to 180 deg, both halves of phi.
std::vector<double> azimuth_weights(const std::vector<Angle>& grid) {
  std::vector<double> weights(grid.size(), 0.0);
  for (std::size_t k = 0; k + 1 < grid.size(); ++k) {
    const double width = (grid[k + 1] - grid[k]).si();
    weights[k] += width;
    weights[k + 1] += width;
  }
  return weights;
}

std::size_t node_of(const ShapeTable& table, std::size_t i, std::size_t r, std::size_t p) {
  return (i * table.theta_r().size() + r) * table.phi().size() + p;
}

Geometry geometry_of(const ShapeTable& table, std::size_t i, std::size_t r, std::size_t p) {
  return {.theta_i = table.theta_i()[i], .phi_i = {}, .theta_r = table.theta_r()[r], .phi_r = table.phi()[p]};
}

std::optional<std::size_t> place_in(const std::vector<Angle>& grid, Angle theta) {
  constexpr Angle kSame = degrees(1e-6);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    if (grid[k] >= theta - kSame && grid[k] <= theta + kSame) return k;
  }
  return std::nullopt;
}

double u_of_modes(const ReferenceStandard& standard, const Geometry& g, Wavelength wavelength) {
  double sum = square_of(kDigitsOfATable);
  for (std::size_t k = 0; k < standard.modes().size(); ++k) {
    sum += square_of(standard.mode(k, g, wavelength) * standard.modes()[k].u);
  }
  return std::sqrt(sum);
}

double in_own_u(const ReciprocityPair& pair) {
  return 0.5 * std::abs(pair.gap) / pair.u;
}

double in_own_u(const HemisphereShare& share) {
  return (share.reflectance - 1.0) / share.u;
}

/// Looks at one table after the other.
class ShapeInspection {
 public:
  explicit ShapeInspection(const ReferenceStandard& standard) : standard_(standard) {}

  ShapeReport report() {
    for (std::size_t n = 0; n < standard_.shapes().size(); ++n) {
      const double as_written = 1.0 / standard_.scale(n);
      if (std::abs(std::log(as_written)) > std::abs(std::log(report_.as_written))) report_.as_written = as_written;
      compare_pairs(n);
    }
    weigh_energy(true);
    weigh_energy(false);
    judge();
    return std::move(report_);
  }

 private:
  void compare_pairs(std::size_t n) {
    const ShapeTable& table = standard_.shapes()[n].table;
    for (std::size_t i = 0; i < table.theta_i().size(); ++i) {
      const auto as_view = place_in(table.theta_r(), table.theta_i()[i]);
      for (std::size_t r = 0; as_view && r < table.theta_r().size(); ++r) {
        const auto as_light = place_in(table.theta_i(), table.theta_r()[r]);
        if (!as_light || *as_light <= i) continue;
        for (std::size_t p = 0; p < table.phi().size(); ++p) {
          compare(n, geometry_of(table, i, r, p), table.values()[node_of(table, i, r, p)],
                  table.values()[node_of(table, *as_light, *as_view, p)]);
        }
      }
    }
  }

  void compare(std::size_t n, const Geometry& forth, double s_forth, double s_back) {
    const Wavelength wavelength = standard_.shapes()[n].wavelength;
    ReciprocityPair pair{.wavelength = wavelength,
                         .forth = forth,
                         .gap = 2.0 * (s_forth - s_back) / (s_forth + s_back),
                         .u = kDigitsOfATable};
    report_.largest_gap = std::max(report_.largest_gap, std::abs(pair.gap));
    // The modes only widen u: most pairs need not ask them.
    if (report_.worst_pair && in_own_u(pair) <= in_own_u(*report_.worst_pair)) return;
    pair.u = u_of_modes(standard_, forth, wavelength);
    if (!report_.worst_pair || in_own_u(pair) > in_own_u(*report_.worst_pair)) report_.worst_pair = pair;
  }

  // The (1/pi) integral of the scaled table, and of it times each mode, over the other direction of node `fixed`.
  struct Integrals {
    double shape = 0.0;
    std::vector<double> modes;
  };
  [[nodiscard]] Integrals integrals(std::size_t n, bool is_of_incidence, std::size_t fixed) const {
    const ShapeTable& table = standard_.shapes()[n].table;
    const std::vector<double> around = azimuth_weights(table.phi());
    const std::vector<double> down = hemisphere_weights(is_of_incidence ? table.theta_r() : table.theta_i());
    Integrals sums{.shape = 0.0, .modes = std::vector<double>(standard_.modes().size(), 0.0)};
    for (std::size_t t = 0; t < down.size(); ++t) {
      for (std::size_t p = 0; p < around.size(); ++p) {
        const std::size_t i = is_of_incidence ? fixed : t;
        const std::size_t r = is_of_incidence ? t : fixed;
        const double part = standard_.scale(n) * table.values()[node_of(table, i, r, p)] * down[t] * around[p] / kPi;
        sums.shape += part;
        const Geometry g = geometry_of(table, i, r, p);
        for (std::size_t k = 0; k < sums.modes.size(); ++k) {
          sums.modes[k] += part * (standard_.modes()[k].value(g) - standard_.mode_mean(k, n));
        }
      }
    }
    return sums;
  }

  void weigh_energy(bool is_of_incidence) {
    const ShapeTable& table = standard_.shapes().front().table;
    const auto& thetas = is_of_incidence ? table.theta_i() : table.theta_r();
    for (std::size_t fixed = 0; fixed < thetas.size(); ++fixed) {
      std::vector<Integrals> of_tables;
      for (std::size_t n = 0; n < standard_.shapes().size(); ++n) {
        of_tables.push_back(integrals(n, is_of_incidence, fixed));
      }
      for (const CertificateEntry& entry : standard_.certificate().entries) {
        const auto between = place_between(entry.wavelength);
        if (between) weigh(entry, *between, of_tables, {.theta = thetas[fixed], .is_of_incidence = is_of_incidence});
      }
    }
  }

  struct Between {
    std::size_t below = 0;
    double fraction = 0.0;
  };
  // Among the tables; none beyond them.
  [[nodiscard]] std::optional<Between> place_between(Wavelength wavelength) const {
    const auto shapes = standard_.shapes();
    if (shapes.size() == 1) return Between{};
    for (std::size_t n = 0; n + 1 < shapes.size(); ++n) {
      const double fraction = (wavelength - shapes[n].wavelength) / (shapes[n + 1].wavelength - shapes[n].wavelength);
      if (fraction >= 0.0 && fraction <= 1.0) return Between{n, fraction};
    }
    return std::nullopt;
  }

  void weigh(const CertificateEntry& entry, Between at, const std::vector<Integrals>& of_tables,
             HemisphereShare share) {
    const Integrals& below = of_tables[at.below];
    const Integrals& above = at.fraction > 0.0 ? of_tables[at.below + 1] : below;
    const auto mean = [&](double a, double b) { return a + at.fraction * (b - a); };
    const double shape = mean(below.shape, above.shape);
    share.wavelength = entry.wavelength;
    share.reflectance = entry.reflectance * shape;
    double variance = square_of(entry.u * shape) + square_of(share.reflectance * standard_.u_integral()) +
                      square_of(share.reflectance * kDigitsOfATable);
    for (std::size_t k = 0; k < standard_.modes().size(); ++k) {
      variance += square_of(entry.reflectance * mean(below.modes[k], above.modes[k]) * standard_.modes()[k].u);
    }
    share.u = std::sqrt(variance);
    if (!report_.brightest || in_own_u(share) > in_own_u(*report_.brightest)) report_.brightest = share;
  }

  void judge() {
    const double pair = report_.worst_pair ? in_own_u(*report_.worst_pair) : 0.0;
    const double share = report_.brightest ? in_own_u(*report_.brightest) : 0.0;
    const bool is_too_bright = share > kExpanded && report_.brightest->reflectance > 1.0 + kExcessOfTables;
    report_.verdict = pair > kExpanded || is_too_bright ? ShapeVerdict::Contradicts
                      : pair > 1.0 || share > 1.0       ? ShapeVerdict::Doubtful
                                                        : ShapeVerdict::Sound;
    if (pair > 1.0) report_.findings.push_back(pair_sentence());
    if (share > 1.0) report_.findings.push_back(share_sentence());
    if (is_too_bright && pair > 1.0 && pair <= kExpanded) std::swap(report_.findings[0], report_.findings[1]);
    add_scale_sentence();
  }

  [[nodiscard]] std::string at_wavelength(Wavelength wavelength) const {
    return standard_.shapes().size() > 1 ? fmt::format(" at {:g} nm", in_nanometres(wavelength)) : std::string();
  }

  [[nodiscard]] std::string pair_sentence() const {
    const ReciprocityPair& pair = *report_.worst_pair;
    const double i = in_degrees(pair.forth.theta_i);
    const double r = in_degrees(pair.forth.theta_r);
    const double dphi = in_degrees(pair.forth.phi_r);
    return fmt::format(
        "it breaks reciprocity{}: (theta_i, theta_r, dphi) = ({:g}, {:g}, {:g}) deg and ({:g}, {:g}, {:g}) deg differ "
        "by "
        "{:.2g} %, so that one of them is wrong by {:.2g} % at least, {:.1f} times the u of {:.2g} % that its modes "
        "give "
        "there; the largest gap of all is {:.2g} %",
        at_wavelength(pair.wavelength), i, r, dphi, r, i, dphi, kPercent * std::abs(pair.gap),
        0.5 * kPercent * std::abs(pair.gap), in_own_u(pair), kPercent * pair.u, kPercent * report_.largest_gap);
  }

  [[nodiscard]] std::string share_sentence() const {
    const HemisphereShare& share = *report_.brightest;
    return fmt::format(
        "it sends back more light than it gets: {:.4f} for {} = {:g} deg at {:g} nm, {:.1f} times its u of {:.2g} "
        "above 1",
        share.reflectance, share.is_of_incidence ? "theta_i" : "theta_r", in_degrees(share.theta),
        in_nanometres(share.wavelength), in_own_u(share), share.u);
  }

  // A file may have any scale; one that is nearly right was meant to be right.
  void add_scale_sentence() {
    constexpr double kMeantToBeOne = 0.2;
    constexpr double kOwnCap = 5e-3;  // what its author put where the table ends
    const double off = std::abs(report_.as_written - 1.0);
    if (off <= kOwnCap || off > kMeantToBeOne) return;
    report_.findings.push_back(
        fmt::format("as written it gives {:.4f} in the certificate's own geometry, not 1: it counts as a shape alone, "
                    "times {:.4f}",
                    report_.as_written, 1.0 / report_.as_written));
  }

  const ReferenceStandard& standard_;
  ShapeReport report_;
};

}  // namespace

std::string_view verdict_name(ShapeVerdict verdict) {
  switch (verdict) {
    case ShapeVerdict::Sound:
      return "sound";
    case ShapeVerdict::Doubtful:
      return "doubtful";
    case ShapeVerdict::Contradicts:
      break;
  }
  return "contradicts itself";
}

ShapeReport check_shape(const ReferenceStandard& standard) {
  return ShapeInspection(standard).report();
}

Result<void> demand_consistency(const ReferenceStandard& standard, const ShapeReport& report) {
  if (report.verdict != ShapeVerdict::Contradicts) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .device = {},
                  .tried = "use the shape table of " + standard.serial(),
                  .seen = report.findings.front(),
                  .limit = "2 u: a table that is reciprocal and returns at most all light, or modes that say how wrong "
                           "it may be",
                  .where = standard.shape_location()});
}

}  // namespace gonio::calibration
