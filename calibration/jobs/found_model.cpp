#include "calibration/jobs/found_model.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/jobs/direct_beam.h"

namespace gonio::calibration {

namespace {

constexpr std::array<std::string_view, 3> kZeros{"zero_theta_i_deg", "zero_theta_r_deg", "zero_phi_r_deg"};

void put_linearity(InstrumentModel& model, const FoundValues& found) {
  std::vector<std::size_t> places;
  for (int power = 1;; ++power) {
    const auto place = found.place_of("linearity_" + std::to_string(power));
    if (!place) break;
    places.push_back(*place);
  }
  const auto offset = found.place_of("exposure_offset_s");
  if (places.empty() || !offset) return;
  LinearityModel& linearity = model.detector.linearity;
  linearity = {};
  for (const std::size_t place : places) linearity.coefficients.push_back(found.values[place].value);
  places.push_back(*offset);
  const std::size_t n = found.values.size();
  for (const std::size_t a : places) {
    for (const std::size_t b : places) linearity.covariance.push_back(found.covariance[a * n + b]);
  }
  model.detector.exposure_offset_s = {.value = found.values[*offset].value, .u = found.u(*offset)};
  model.detector.u_linearity = 0.0;
}

void put_zeros(InstrumentModel& model, const FoundValues& found) {
  std::array<std::size_t, 3> places{};
  for (std::size_t axis = 0; axis < places.size(); ++axis) {
    const auto place = found.place_of(kZeros[axis]);
    if (!place) return;
    places[axis] = *place;
  }
  const double degree = in_radians(degrees(1.0));
  const std::size_t n = found.values.size();
  for (std::size_t a = 0; a < places.size(); ++a) {
    model.angles.zero[a] = degrees(found.values[places[a]].value);
    for (std::size_t b = 0; b < places.size(); ++b) {
      model.angles.zero_covariance[a * 3 + b] = found.covariance[places[a] * n + places[b]] * degree * degree;
    }
  }
}

// Without a stated stop nothing is absolute, whatever the beam.
void put_direct_beams(InstrumentModel& model, const FoundValues& found) {
  if (!model.absolute) return;
  std::vector<DirectBeam> beams = direct_beams_of(found);
  if (!beams.empty()) model.absolute->beams = std::move(beams);
}

}  // namespace

Result<InstrumentModel> with_found(InstrumentModel model, const FoundValues& found) {
  if (found.covariance.size() != found.values.size() * found.values.size()) {
    return failure(
        {.code = ErrorCode::IncompleteData,
         .tried = "put found values into the instrument's model",
         .seen = fmt::format("{} values and {} numbers of covariance", found.values.size(), found.covariance.size()),
         .limit = "the square of the number of values"});
  }
  put_linearity(model, found);
  put_zeros(model, found);
  put_direct_beams(model, found);
  return model;
}

}  // namespace gonio::calibration
