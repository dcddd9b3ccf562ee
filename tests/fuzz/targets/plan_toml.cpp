// plan.toml, as a client sends it.
#include <cmath>

#include "protocol/api/plan.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

const std::string kFile = "plan.toml";

void hold_angles(const std::vector<Angle>& angles, double least_deg, double most_deg) {
  hold(!angles.empty(), "no list is empty");
  for (const Angle angle : angles) {
    const double value = in_degrees(angle);
    hold(value >= least_deg - 1e-9 && value <= most_deg + 1e-9,
         "an angle is finite and in its range");  // false for NaN too
  }
}

}  // namespace

void plan_toml(Bytes input) {
  const std::string_view text = text_of(input);
  const auto plan = api::parse_plan(text, kFile);
  if (!plan) {
    hold_input_error(plan.error(), kFile, text);
    return;
  }
  hold_angles(plan->theta_i, 0.0, 90.0);
  hold_angles(plan->theta_r, 0.0, 90.0);
  hold_angles(plan->phi_i, -360.0, 360.0);
  hold_angles(plan->phi_r, -360.0, 360.0);
  hold(!plan->wavelengths.empty(), "a plan has a wavelength");
  for (const Wavelength wavelength : plan->wavelengths)
    hold(std::isfinite(wavelength.si()) && wavelength.si() > 0.0, "a wavelength is positive");
  hold(std::isfinite(plan->target_snr) && plan->target_snr > 0.0, "the target is positive");
  hold(plan->max_time > Duration::zero() && plan->block > Duration::zero() && plan->dark_every > Duration::zero(),
       "times are positive");
  hold(plan->item_retries >= 0, "retries are counted");
}

}  // namespace gonio::fuzz
