#include "reflectance/light/energy_report.h"

#include <array>
#include <cmath>
#include <optional>

#include "reflectance/integral/directional_reflectance.h"

namespace gonio::reflectance {
namespace {

constexpr std::array kTolerances{1e-6, 1e-9, 1e-12};
constexpr std::array kThetasDeg{0.0,  5.0,  10.0, 15.0,  20.0, 25.0,  30.0,  35.0,   40.0,   45.0,
                                50.0, 55.0, 60.0, 65.0,  70.0, 75.0,  80.0,  82.5,   85.0,   87.0,
                                88.0, 89.0, 89.5, 89.75, 89.9, 89.95, 89.99, 89.999, 89.9999};

// One azimuth of incidence.
class IncidenceScan {
 public:
  IncidenceScan(const Surface& surface, Angle phi, Angle edge) : surface_(surface), phi_(phi), edge_(edge) {}

  [[nodiscard]] std::vector<EnergyExcess> excesses() {
    std::vector<EnergyExcess> found;
    std::optional<EnergyExcess> open;
    Angle before{};
    for (const double theta_deg : kThetasDeg) {
      const Angle theta = degrees(theta_deg);
      const Integral rho = rho_at(theta);
      const bool is_above = exceeds(rho);
      if (is_above && !open) {
        const Angle from = theta == Angle{} ? theta : passing(before, theta);
        open =
            EnergyExcess{.phi_i = phi_, .from_theta_i = from, .to_theta_i = {}, .worst_theta_i = theta, .worst = rho};
      }
      if (is_above && rho.value > open->worst.value) {
        open->worst = rho;
        open->worst_theta_i = theta;
      }
      if (!is_above && open) {
        open->to_theta_i = passing(theta, before);
        found.push_back(*open);
        open.reset();
      }
      before = theta;
    }
    if (open) {
      open->to_theta_i = degrees(90.0);
      found.push_back(*open);
    }
    return found;
  }

  [[nodiscard]] std::uint64_t evaluations() const { return evaluations_; }

 private:
  [[nodiscard]] static bool exceeds(const Integral& rho) { return rho.value - rho.error > 1.0; }

  // As closely as it takes to tell the side of 1, within reason.
  Integral rho_at(Angle theta) {
    const Direction i = Direction::from_angles(theta, phi_);
    Integral rho;
    for (const double tolerance : kTolerances) {
      rho = rho_dh(surface_, i, tolerance);
      evaluations_ += rho.evaluations;
      if (std::abs(rho.value - 1.0) > rho.error) break;
    }
    return rho;
  }

  // Where rho_dh passes 1 between a theta on either side of it: false position in the form of Illinois (Dowell and
  // Jarratt 1971), which keeps the pass enclosed and closes in faster than halving.
  Angle passing(Angle a, Angle b) {
    constexpr int kMostSteps = 60;
    double excess_a = rho_at(a).value - 1.0;
    double excess_b = rho_at(b).value - 1.0;
    for (int k = 0; k < kMostSteps && excess_a != excess_b; ++k) {
      const Angle next = b - (b - a) * (excess_b / (excess_b - excess_a));
      const bool is_close = std::abs((next - b).si()) <= edge_.si();
      const double excess = rho_at(next).value - 1.0;
      if (excess * excess_b <= 0.0) {
        a = b;
        excess_a = excess_b;
      } else {
        excess_a *= 0.5;
      }
      b = next;
      excess_b = excess;
      if (is_close) break;
    }
    return b;
  }

  const Surface& surface_;
  Angle phi_;
  Angle edge_;
  std::uint64_t evaluations_ = 0;
};

}  // namespace

EnergyReport energy_report(const Surface& surface, Angle edge) {
  EnergyReport report;
  const int azimuths = surface.is_isotropic() ? 1 : 12;
  for (int k = 0; k < azimuths; ++k) {
    IncidenceScan scan(surface, degrees(30.0 * k), edge);
    for (const EnergyExcess& excess : scan.excesses()) report.excesses.push_back(excess);
    report.evaluations += scan.evaluations();
  }
  return report;
}

}  // namespace gonio::reflectance
