#include "daemon/config/beams_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace gonio::daemon {
namespace {

constexpr NumberRange kBeamRadius{.least = 1e-3, .most = 1e4, .unit = "mm"};
constexpr NumberRange kBeamDoubt{.least = 0.0, .most = 1e3, .unit = "mm"};
constexpr NumberRange kFalloff{.least = 0.0, .most = 1.0};

Measured<Length> radius(TomlReader& table, const std::string& beam) {
  const Length value = millimetres(table.number(beam + "_radius_mm", kBeamRadius));
  return {value, millimetres(table.number("u_" + beam + "_radius_mm", kBeamDoubt))};
}

std::optional<Length> target_radius(TomlReader& table, std::string_view key) {
  const auto mm = table.optional_number(key, kBeamRadius);
  return mm ? std::optional(millimetres(*mm)) : std::nullopt;
}

// Two lists of one length: where, in units of the radius, and how much.
std::vector<calibration::RadialNode> profile(TomlReader& table, const std::string& beam) {
  const std::string where = beam + "_profile_of_radius";
  const std::string what = beam + "_profile";
  if (table.kind(where) == TomlKind::Absent && table.kind(what) == TomlKind::Absent) return {};
  const std::vector<double> at = table.numbers(where, {.least = 0.0, .most = 100.0});
  const std::vector<double> values = table.numbers(what, {.least = 0.0});
  if (table.has_failed()) return {};
  const bool ascends = std::adjacent_find(at.begin(), at.end(), std::greater_equal<>()) == at.end();
  if (at.size() != values.size() || !ascends || values.front() <= 0.0) {
    table.fail(what, ErrorCode::InvalidInput, fmt::format("{} values at {} places", values.size(), at.size()),
               "as many as places, these ascending, the first value above 0");
    return {};
  }
  std::vector<calibration::RadialNode> nodes;
  for (std::size_t k = 0; k < at.size(); ++k) nodes.push_back({at[k], values[k]});
  return nodes;
}

}  // namespace

void read_beams(TomlReader& root, calibration::InstrumentModel& model) {
  auto table = root.optional_table("beams");
  if (!table) return;
  auto& beams = model.overlap.emplace();
  beams.spot_radius = radius(*table, "spot");
  beams.field_radius = radius(*table, "field");
  beams.sample_radius = target_radius(*table, "sample_radius_mm");
  beams.reference_radius = target_radius(*table, "reference_radius_mm");
  beams.u_target_radius = millimetres(table->number_or("u_target_radius_mm", 0.0, kBeamDoubt));
  beams.u_spot_falloff = table->number_or("u_spot_falloff", 0.0, kFalloff);
  beams.u_field_falloff = table->number_or("u_field_falloff", 0.0, kFalloff);
  beams.u_offset = millimetres(table->number_or("u_offset_mm", 0.0, kBeamDoubt));
  beams.spot_profile = profile(*table, "spot");
  beams.field_profile = profile(*table, "field");
}

}  // namespace gonio::daemon
