// reference/*.toml: whatever is taken for a standard has a finite, positive reflectance wherever it says it reaches.
#include <cmath>

#include "calibration/reference_standard.h"
#include "calibration/shape_check.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

const std::string kFile = "reference.toml";

void hold_at(const calibration::ReferenceStandard& standard, Wavelength wavelength, const Geometry& g) {
  const auto within = standard.check_reach(wavelength, g);
  if (!within) {
    hold_error(within.error());
    return;
  }
  const auto reflectance = standard.reflectance(wavelength);
  hold(reflectance.has_value(), "a wavelength within reach has a reflectance");
  hold(std::isfinite(reflectance->value) && reflectance->value > 0.0, "a reflectance is positive");
  hold(std::isfinite(reflectance->u) && reflectance->u >= 0.0, "an uncertainty is not negative");
  const double shape = standard.shape(g, wavelength);
  hold(std::isfinite(shape) && shape > 0.0, "a shape is positive");
  hold(std::isfinite(standard.u_interpolation(g, wavelength)), "the error between nodes is finite");
  for (std::size_t k = 0; k < standard.modes().size(); ++k)
    hold(std::isfinite(standard.mode(k, g, wavelength)), "a mode is finite");
}

}  // namespace

void reference_toml(Bytes input) {
  const std::string_view text = text_of(input);
  const auto standard = calibration::ReferenceStandard::parse(text, kFile);
  if (!standard) {
    hold_input_error(standard.error(), kFile, text);
    return;
  }
  const calibration::ShapeReport shape = calibration::check_shape(*standard);
  hold(std::isfinite(shape.largest_gap), "a table's gap is finite");
  const auto now = UtcTime(std::chrono::sys_days(std::chrono::year(2026) / 11 / 22));
  if (const auto valid = standard->check_date(now); !valid) hold_error(valid.error());
  for (const double lambda : {450.0, 568.0, 850.0}) {
    for (const double theta : {0.0, 8.0, 45.0, 89.0}) {
      const Geometry g{
          .theta_i = degrees(theta), .phi_i = degrees(0.0), .theta_r = degrees(45.0), .phi_r = degrees(123.0)};
      hold_at(*standard, nanometres(lambda), g);
    }
  }
}

}  // namespace gonio::fuzz
