#include "sim/devices/detector_charge.h"

#include "sim/optics/detector_response.h"

namespace gonio::sim {

double DetectorCharge::signal(double electrons) const {
  const double bent = after_nonlinearity(scene_.detector, electrons, truth_.nonlinearity());
  if (!scene_.effects.response) return bent;
  const double full_scale = scene_.detector.full_scale_dn() * scene_.detector.electrons_per_dn;
  return full_scale * response(*scene_.effects.response, bent / full_scale);
}

Exposure DetectorCharge::collect(const LightRate& light, double lamp, double from_s, double length_s) const {
  const DetectorSpec& detector = scene_.detector;
  double lit = light.target * lamp;
  double veil = light.veil * lamp + light.ambient;
  double dark = detector.dark_dn_per_s * detector.electrons_per_dn * length_s;
  if (scene_.effects.exposure_offset_s != 0.0) {
    const double longer = 1.0 + scene_.effects.exposure_offset_s / length_s;
    for (double* part : {&lit, &veil, &dark}) *part *= longer;
  }
  const double middle_s = from_s + 0.5 * length_s;
  if (scene_.effects.dark_drift) dark *= drift_.rate_factor(middle_s);
  const double veil_signal = signal(veil);
  return {.light_electrons = signal(lit + veil) - veil_signal,
          .dark_electrons = veil_signal + dark,
          .offset_shift_dn = drift_.offset_shift_dn(middle_s)};
}

}  // namespace gonio::sim
