#include "protocol/api/plan_calibration.h"

#include <fmt/format.h>

#include <cmath>

#include "protocol/api/plan.h"
#include "protocol/api/toml_values.h"

namespace gonio::api {

namespace {

constexpr std::string_view kSection = "calibration";

// From -half to half, symmetrical, at most `step` apart.
std::vector<double> offsets(double half, double step) {
  const int each_side = std::max(1, static_cast<int>(std::lround(half / step)));
  std::vector<double> values;
  for (int k = -each_side; k <= each_side; ++k) values.push_back(half * k / each_side);
  return values;
}

std::vector<Angle> angles(double middle_deg, const std::vector<double>& offsets_deg, double stretch = 1.0) {
  std::vector<Angle> all;
  for (const double offset : offsets_deg) all.push_back(degrees(without_creep(middle_deg + stretch * offset)));
  return all;
}

PlanPart crossing(const TomlReader& table, Wavelength wavelength, double theta_i_deg, std::vector<Angle> theta_r,
                  std::vector<Angle> phi_r) {
  PlanPart part{.where = table.location("theta_i_deg"),
                .theta_i = {degrees(theta_i_deg)},
                .phi_i = {Angle{}},
                .wavelengths = {wavelength},
                .shape = ProductShape{std::move(theta_r), std::move(phi_r)}};
  part.where.field = kSection;
  return part;
}

// Crossings of the mirror's lobe along theta_r and phi_r at each theta_i, and across the normal.
void read_arm_zeros(TomlReader& table, Plan& plan, PlanCalibration& wanted) {
  constexpr NumberRange kTheta{.least = 5.0, .most = 80.0, .unit = "deg"};
  constexpr NumberRange kWidth{.least = 0.02, .most = 5.0, .unit = "deg"};
  constexpr NumberRange kWavelength{.least = 100.0, .most = 20'000.0, .unit = "nm"};
  const Wavelength wavelength = nanometres(table.number("wavelength_nm", kWavelength));
  const std::vector<double> thetas = read_values(table, "theta_i_deg", kTheta);
  const double half = table.number_or("half_width_deg", 0.6, kWidth);
  const double step = table.number_or("step_deg", 0.15, kWidth);
  wanted.u_mirror = degrees(table.number("u_mirror_deg", {.least = 0.0, .most = 5.0, .unit = "deg"}));
  constexpr std::size_t kLeast = 3;
  if (thetas.size() < kLeast) {
    table.fail("theta_i_deg", ErrorCode::InvalidInput, fmt::format("{} angles", thetas.size()), "three at least");
  }
  if (step > half / 2.0) {
    table.fail("step_deg", ErrorCode::InvalidInput, fmt::format("{} deg", step),
               fmt::format("at most half of half_width_deg = {} deg", half));
  }
  if (table.has_failed()) return;
  const std::vector<double> across = offsets(half, step);
  for (const double theta : thetas) {
    const double stretch = 1.0 / std::sin(in_radians(degrees(theta)));
    plan.parts.push_back(crossing(table, wavelength, theta, angles(theta, across), {degrees(180.0)}));
    plan.parts.push_back(crossing(table, wavelength, theta, {degrees(theta)}, angles(180.0, across, stretch)));
  }
  // One side of the lobe only on each azimuth: twice as fine.
  const std::vector<double> fine = offsets(half, 0.5 * step);
  const std::vector<double> outward(fine.begin() + std::ssize(fine) / 2 + 1, fine.end());
  plan.parts.push_back(crossing(table, wavelength, 0.0, angles(0.0, outward),
                                {degrees(0.0), degrees(90.0), degrees(180.0), degrees(270.0)}));
  plan.isotropic = false;  // at the normal each azimuth is a crossing of its own
}

// What both jobs say that look into the source; the detector stands opposite to it, below the surface.
struct Look {
  std::vector<Wavelength> wavelengths;
  double theta_i_deg = 0.0;
  int repeats = 1;
  [[nodiscard]] double straight_deg() const { return 180.0 - theta_i_deg; }
  /// As far along phi_r as an angle at the stage's centre is.
  [[nodiscard]] double along_phi() const { return 1.0 / std::sin(in_radians(degrees(straight_deg()))); }
};

Look read_look(TomlReader& table, int repeats) {
  constexpr NumberRange kTheta{.least = 45.0, .most = 89.0, .unit = "deg"};
  constexpr NumberRange kWavelength{.least = 100.0, .most = 20'000.0, .unit = "nm"};
  constexpr int kMostRepeats = 1000;
  Look look;
  for (const double nm : read_values(table, "wavelength_nm", kWavelength)) look.wavelengths.push_back(nanometres(nm));
  look.theta_i_deg = table.number("theta_i_deg", kTheta);
  look.repeats = static_cast<int>(table.integer_or("repeats", repeats, 1, kMostRepeats));
  return look;
}

PlanPart look_at(const TomlReader& table, const Look& look, std::vector<Angle> theta_r, std::vector<Angle> phi_r) {
  PlanPart part = crossing(table, {}, look.theta_i_deg, std::move(theta_r), std::move(phi_r));
  part.wavelengths = look.wavelengths;
  part.repeats = look.repeats;
  return part;
}

// Straight through, and beside it on four sides: theta_r and, as far along its circle, phi_r.
void read_direct_beam(TomlReader& table, Plan& plan) {
  constexpr NumberRange kBeside{.least = 0.01, .most = 5.0, .unit = "deg"};
  const Look look = read_look(table, 3);
  const double beside = table.number_or("beside_deg", 0.1, kBeside);
  if (table.has_failed()) return;
  const double straight = look.straight_deg();
  const double along_phi = beside * look.along_phi();
  const auto add = [&](double theta_r, double phi_r) {
    plan.parts.push_back(look_at(table, look, angles(theta_r, {0.0}), angles(phi_r, {0.0})));
  };
  add(straight, 180.0);
  for (const double side : {-1.0, 1.0}) {
    add(straight + side * beside, 180.0);
    add(straight, 180.0 + side * along_phi);
  }
  plan.isotropic = false;  // its four sides are four places
  plan.reference_mode = ReferenceMode::Absolute;
}

// The beam crossed along theta_r and, as far along its circle, along phi_r. Both cross in the middle, which is read
// with the first.
void read_signature(TomlReader& table, Plan& plan) {
  constexpr NumberRange kHalf{.least = 0.02, .most = 30.0, .unit = "deg"};
  constexpr NumberRange kStep{.least = 0.002, .most = 10.0, .unit = "deg"};
  const Look look = read_look(table, 1);
  const double half = table.number("half_width_deg", kHalf);
  const double step = table.number("step_deg", kStep);
  if (table.has_failed()) return;
  constexpr double kStepsAtLeast = 4.0;
  if (step > half / kStepsAtLeast) {
    table.fail("step_deg", ErrorCode::InvalidInput, fmt::format("{} deg", step),
               fmt::format("at most a quarter of half_width_deg = {} deg", half));
  }
  if (!(look.straight_deg() - half > 90.0)) {
    table.fail(
        "half_width_deg", ErrorCode::InvalidInput, fmt::format("from theta_r = {} deg on", look.straight_deg() - half),
        fmt::format("beyond 90 deg, where an attenuator stands in the beam: below {} deg, or another theta_i_deg",
                    90.0 - look.theta_i_deg));
  }
  if (table.has_failed()) return;
  std::vector<double> across = offsets(half, step);
  plan.parts.push_back(look_at(table, look, angles(look.straight_deg(), across), {degrees(180.0)}));
  across.erase(across.begin() + std::ssize(across) / 2);
  plan.parts.push_back(look_at(table, look, {degrees(look.straight_deg())}, angles(180.0, across, look.along_phi())));
  plan.isotropic = false;  // both sides of the plane of incidence
  plan.reference_mode = ReferenceMode::Absolute;
}

}  // namespace

bool read_calibration(TomlReader& root, Plan& plan) {
  std::optional<TomlReader> table = root.optional_table(kSection);
  if (!table) return false;
  PlanCalibration wanted{.job = static_cast<CalibrationJob>(table->choice("job", kCalibrationJobNames))};
  if (table->has_failed()) return false;
  if (wanted.job == CalibrationJob::Linearity) wanted.order = static_cast<int>(table->integer_or("order", 2, 1, 3));
  if (wanted.job == CalibrationJob::ArmZeros) read_arm_zeros(*table, plan, wanted);
  if (wanted.job == CalibrationJob::DirectBeam) read_direct_beam(*table, plan);
  if (wanted.job == CalibrationJob::Signature) read_signature(*table, plan);
  constexpr int kMostFrames = 4096;
  if (makes_maps(wanted.job))
    wanted.frames = static_cast<int>(table->integer_or("frames", wanted.frames, 2, kMostFrames));
  plan.calibration = wanted;
  return wanted.job == CalibrationJob::ArmZeros || looks_into_source(wanted.job);
}

void refuse_targets_beside_a_beam(TomlReader& root, const Plan& plan) {
  if (!plan.calibration || !looks_into_source(plan.calibration->job) || root.has_failed()) return;
  if (plan.reference_mode != ReferenceMode::Absolute) {
    root.table("reference")
        .fail("mode", ErrorCode::InvalidInput, "a direct beam beside a standard", "mode = \"absolute\", or none");
  }
  if (plan.reference_every > Duration::zero() || plan.check_every > Duration::zero()) {
    const std::string_view visits = plan.check_every > Duration::zero() ? "check_s" : "reference_s";
    root.table("visits").fail(visits, ErrorCode::InvalidInput, "visits of a target that is not there",
                              "dark_s only: straight through nothing stands on the stage");
  }
}

void check_flat_field(TomlReader& root, const Plan& plan) {
  if (!plan.calibration || plan.calibration->job != CalibrationJob::FlatField || root.has_failed()) return;
  if (plan.exposures.empty()) {
    root.table("reading").fail("exposure_s", ErrorCode::MissingKey, "exposures chosen reading by reading",
                               "one at least: a reading's frames of one exposure are summed");
  }
  if (plan.reference_mode != ReferenceMode::SameGeometry) {
    root.table("reference")
        .fail("mode", ErrorCode::InvalidInput, "a standard that is not read at the plan's geometries",
              "mode = \"same-geometry\": the standard is the even light");
  }
}

void make_ladder(TomlReader& root, Plan& plan) {
  if (!plan.calibration || plan.calibration->job != CalibrationJob::Linearity || root.has_failed()) return;
  TomlReader reading = root.table("reading");
  const std::size_t needed = static_cast<std::size_t>(plan.calibration->order) + 3;
  if (plan.exposures.size() < needed) {
    reading.fail("exposure_s", plan.exposures.empty() ? ErrorCode::MissingKey : ErrorCode::InvalidInput,
                 fmt::format("{} exposures", plan.exposures.size()),
                 fmt::format("{} at least, for a polynomial of order {} and an exposure offset", needed,
                             plan.calibration->order));
    return;
  }
  Duration sum{};
  for (const Duration exposure : plan.exposures) sum += 2 * exposure;
  if (sum > plan.max_time) {
    reading.fail("exposure_s", ErrorCode::InvalidInput, fmt::format("{} s up and down the ladder", in_seconds(sum)),
                 fmt::format("at most max_time_s = {} s", in_seconds(plan.max_time)));
    return;
  }
  plan.exposures.insert(plan.exposures.end(), plan.exposures.rbegin(), plan.exposures.rend());
}

}  // namespace gonio::api
