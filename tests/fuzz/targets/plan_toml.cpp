// plan.toml, as a client sends it, with a list of points beside it; and any text as that list.
#include <cmath>
#include <map>

#include "protocol/api/plan.h"
#include "protocol/api/point_list.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

const std::string kFile = "plan.toml";

const std::string kListFile = "points.csv";

void hold_angles(const std::vector<Angle>& angles, double least_deg, double most_deg) {
  hold(!angles.empty(), "no list is empty");
  for (const Angle angle : angles) {
    const double value = in_degrees(angle);
    hold(value >= least_deg - 1e-9 && value <= most_deg + 1e-9,
         "an angle is finite and in its range");  // false for NaN too
  }
}

void hold_wavelength(Wavelength wavelength) {
  hold(std::isfinite(wavelength.si()) && wavelength.si() > 0.0, "a wavelength is positive");
}

void hold_list(const api::ListShape& list) {
  hold(!list.points.empty(), "a list has points");
  for (const api::ListedPoint& point : list.points) {
    hold_angles({point.theta_i, point.theta_r}, 0.0, 90.0);
    hold_angles({point.phi_i, point.phi_r}, -360.0, 360.0);
    if (point.wavelength) hold_wavelength(*point.wavelength);
    hold(point.line > 0, "a listed point has its line");
  }
}

void hold_part(const api::PlanPart& part) {
  hold(part.repeats >= 1, "a point is measured at least once");
  for (const Wavelength wavelength : part.wavelengths) hold_wavelength(wavelength);
  if (const auto* list = std::get_if<api::ListShape>(&part.shape)) return hold_list(*list);
  hold(!part.wavelengths.empty(), "a part has a wavelength");
  hold_angles(part.theta_i, 0.0, 90.0);
  hold_angles(part.phi_i, -360.0, 360.0);
  if (const auto* cone = std::get_if<api::ConeShape>(&part.shape)) {
    hold(cone->finest > Angle{} && cone->coarsest >= cone->finest, "spacings are positive and grow");
  }
}

// Any text, as a file that a plan names.
void point_list(std::string_view text) {
  const auto list = api::parse_point_list(text, kListFile);
  if (!list) return hold_input_error(list.error(), kListFile, text);
  hold_list(*list);
}

}  // namespace

void plan_toml(Bytes input) {
  const std::string_view text = text_of(input);
  point_list(text);
  static const std::map<std::string, std::string> kFiles{
      {kListFile, "theta_i_deg,theta_r_deg,phi_r_deg,wavelength_nm\n30,10,90,568\n"}};
  const auto plan = api::parse_plan(text, kFile, kFiles);
  if (!plan) {
    hold_input_error(plan.error(), kFile, text);
    return;
  }
  hold(!plan->theta_r.empty() || !plan->parts.empty(), "a plan has points");
  if (!plan->theta_r.empty()) {
    hold_angles(plan->theta_i, 0.0, 90.0);
    hold_angles(plan->theta_r, 0.0, 90.0);
    hold_angles(plan->phi_i, -360.0, 360.0);
    hold_angles(plan->phi_r, -360.0, 360.0);
    hold(!plan->wavelengths.empty(), "a plan has a wavelength");
    for (const Wavelength wavelength : plan->wavelengths) hold_wavelength(wavelength);
  }
  for (const api::PlanPart& part : plan->parts) hold_part(part);
  hold(std::isfinite(plan->target_snr) && plan->target_snr > 0.0, "the target is positive");
  hold(plan->max_time > Duration::zero() && plan->block > Duration::zero() && plan->dark_every > Duration::zero(),
       "times are positive");
  hold(plan->item_retries >= 0, "retries are counted");
}

}  // namespace gonio::fuzz
