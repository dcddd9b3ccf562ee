// What a line on the control socket means.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "sim/goniosim/control_server.h"

namespace gonio::sim {
namespace {

using nlohmann::json;
using stage::Axis;

json refusal(std::string why) {
  return {{"ok", false}, {"error", std::move(why)}};
}

json stage_report(LiveInstrument& instrument) {
  return instrument.with([](LiveInstrument::Parts& parts) {
    const StageModel& stage = parts.instrument.stage();
    const stage::RegisterMap& map = parts.instrument.scene().stage.registers;
    json axes = json::object();
    for (const Axis a : stage::kAllAxes) {
      const AxisModel& axis = stage.axis(a);
      axes[std::string(stage::axis_name(a))] = {
          {"position", axis.counts(parts.now) * map.axis_scale[stage::index_of(a)]},
          {"target", axis.destination()},
          {"moving", axis.is_moving(parts.now)},
          {"homed", axis.is_homed()}};
    }
    return json{{"ok", true},
                {"axes", axes},
                {"moving", stage.is_moving(parts.now)},
                {"homed", stage.is_homed()},
                {"halted", stage.is_halted()},
                {"heartbeat_tripped", stage.is_tripped()},
                {"fault", stage.fault()},
                {"stop_count", stage.stop_count()},
                {"boot_counter", stage.boot_counter()},
                {"epoch", stage.epoch()},
                {"motion_commands", stage.motion_commands()},
                {"shutter_commands", stage.shutter_commands()}};
  });
}

std::string_view station_name(Station station) {
  switch (station) {
    case Station::Sample:
      return "sample";
    case Station::Reference:
      return "reference";
    case Station::Trap:
      return "trap";
    case Station::Between:
      break;
  }
  return "between";
}

json exposure_report(LiveInstrument& instrument) {
  const InstrumentMemory memory =
      instrument.with([](LiveInstrument::Parts& parts) { return parts.instrument.memory(parts.now); });
  json rows = json::array();
  for (const auto& [place, count] : memory.places) {
    rows.push_back({{"station", station_name(place.station)},
                    {"theta_i_deg", place.centidegrees[0] / 100.0},
                    {"theta_r_deg", place.centidegrees[1] / 100.0},
                    {"phi_r_deg", place.centidegrees[2] / 100.0},
                    {"lit", place.is_lit},
                    {"exposures", count}});
  }
  return {
      {"ok", true}, {"exposures", memory.exposures}, {"lit_exposures", memory.lit_exposures}, {"by_geometry", rows}};
}

json block_axis(const json& line, bool on, LiveInstrument& instrument) {
  const std::string name = line.value("axis", "");
  const auto axis = stage::axis_from_name(name);
  if (!axis) return refusal(fmt::format("there is no axis \"{}\"", name));
  instrument.with([&](LiveInstrument::Parts& parts) {
    if (on)
      parts.instrument.stage().block_axis(*axis, parts.now);
    else
      parts.instrument.stage().free_axis(*axis);
  });
  return {{"ok", true}};
}

json set_fault(const json& line, LiveInstrument& instrument, StageWire& stage, GigeCameraServer& camera) {
  const std::string fault = line.at("fault").get<std::string>();
  const bool on = line.value("on", true);
  if (fault == "axis-blocked") return block_axis(line, on, instrument);
  if (fault == "stage-silent")
    stage.set_silent(on);
  else if (fault == "stage-refuse")
    stage.set_refusing(on);
  else if (fault == "camera-silent")
    camera.set_silent(on);
  else if (fault == "interlock-open") {
    instrument.with([&](LiveInstrument::Parts& parts) { parts.instrument.stage().set_interlock(on, parts.now); });
  } else if (fault == "stage-power-cycle") {
    instrument.with([](LiveInstrument::Parts& parts) { parts.instrument.power_cycle_stage(parts.now); });
  } else {
    return refusal(fmt::format("there is no fault \"{}\"", fault));
  }
  return {{"ok", true}};
}

// A refusal repeats what was sent, which need not be UTF-8.
std::string text_of(const json& answer) {
  return answer.dump(-1, ' ', false, json::error_handler_t::replace);
}

json answer_line(const json& line, LiveInstrument& instrument, StageWire& stage, GigeCameraServer& camera) {
  if (line.contains("fault")) return set_fault(line, instrument, stage, camera);
  const std::string query = line.value("query", "");
  if (query == "stage") return stage_report(instrument);
  if (query == "exposures") return exposure_report(instrument);
  return refusal(fmt::format("there is no query \"{}\"", query));
}

}  // namespace

std::string answer_control(const std::string& line, LiveInstrument& instrument, StageWire& stage,
                           GigeCameraServer& camera) {
  try {
    return text_of(answer_line(json::parse(line), instrument, stage, camera));
  } catch (const json::exception& trouble) {
    return text_of(refusal(trouble.what()));
  }
}

}  // namespace gonio::sim
