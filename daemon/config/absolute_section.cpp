#include "daemon/config/absolute_section.h"

namespace gonio::daemon {
namespace {

constexpr NumberRange kStopRadius{.least = 1e-3, .most = 1e3, .unit = "mm"};
constexpr NumberRange kStopDistance{.least = 1.0, .most = 1e5, .unit = "mm"};
constexpr NumberRange kStopDoubt{.least = 0.0, .most = 1e3, .unit = "mm"};

}  // namespace

void read_absolute(TomlReader& root, calibration::InstrumentModel& model) {
  auto table = root.optional_table("absolute");
  if (!table) return;
  auto& absolute = model.absolute.emplace();
  absolute.aperture_radius = {millimetres(table->number("stop_radius_mm", kStopRadius)),
                              millimetres(table->number("u_stop_radius_mm", kStopDoubt))};
  absolute.aperture_distance = {millimetres(table->number("stop_distance_mm", kStopDistance)),
                                millimetres(table->number("u_stop_distance_mm", kStopDoubt))};
}

std::optional<Measured<double>> read_attenuation(TomlReader& filter) {
  const auto passed = filter.optional_number("attenuation", {.least = 1e-9, .most = 1.0});
  if (!passed) return std::nullopt;
  return Measured<double>{*passed, filter.number("u_attenuation", {.least = 0.0, .most = *passed})};
}

}  // namespace gonio::daemon
