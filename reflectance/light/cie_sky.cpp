#include "reflectance/light/cie_sky.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "reflectance/light/brightness.h"

namespace gonio::reflectance {

// Table 1 of the standard: five numbers from six groups of gradation (a, b) and six of indicatrix (c, d, e).
constexpr CieSky::Parameters CieSky::kTypes[15] = {
    {4.0, -0.70, 0.0, -1.0, 0.00},   {4.0, -0.70, 2.0, -1.5, 0.15},   {1.1, -0.80, 0.0, -1.0, 0.00},
    {1.1, -0.80, 2.0, -1.5, 0.15},   {0.0, -1.00, 0.0, -1.0, 0.00},   {0.0, -1.00, 2.0, -1.5, 0.15},
    {0.0, -1.00, 5.0, -2.5, 0.30},   {0.0, -1.00, 10.0, -3.0, 0.45},  {-1.0, -0.55, 2.0, -1.5, 0.15},
    {-1.0, -0.55, 5.0, -2.5, 0.30},  {-1.0, -0.55, 10.0, -3.0, 0.45}, {-1.0, -0.32, 10.0, -3.0, 0.45},
    {-1.0, -0.32, 16.0, -3.0, 0.30}, {-1.0, -0.15, 16.0, -3.0, 0.30}, {-1.0, -0.15, 24.0, -2.8, 0.15},
};

Result<CieSky> CieSky::make(int type, const Direction& sun, double zenith_radiance) {
  if (type < 1 || type > 15) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "make a CIE sky",
                    .seen = fmt::format("type {}", type),
                    .limit = "1 to 15",
                    .where = InputLocation{.file = {}, .field = "type"}});
  }
  GONIO_TRY(check_brightness("CIE sky", "zenith_radiance", zenith_radiance));
  return CieSky(kTypes[type - 1], sun, zenith_radiance);
}

CieSky::CieSky(const Parameters& p, const Direction& sun, double zenith_radiance) : p_(p), sun_(sun) {
  scale_ = zenith_radiance / (gradation(1.0) * indicatrix(sun.theta().si()));
}

double CieSky::radiance(const Direction& i) const {
  return scale_ * gradation(i.mu()) * indicatrix(phase_angle(sun_, i).si());
}

double CieSky::gradation(double mu) const {
  return mu > 0.0 ? 1.0 + p_.a * std::exp(p_.b / mu) : 1.0;  // b < 0: the limit at the horizon
}

double CieSky::indicatrix(double chi) const {
  const double cosine = std::cos(chi);
  const double aureole = std::exp(p_.d * chi) - std::exp(0.5 * std::numbers::pi * p_.d);
  return 1.0 + p_.c * aureole + p_.e * cosine * cosine;
}

}  // namespace gonio::reflectance
