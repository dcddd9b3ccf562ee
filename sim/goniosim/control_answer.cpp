// What a line on the control socket means.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "sim/goniosim/control_server.h"
#include "sim/scene/check_fault.h"

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
    case Station::Open:
      return "open";
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

// {"name": ..., "after": 3, "axis": "theta_r"}: what the key says it is, number or name.
FaultWish wish_of(const json& line) {
  FaultWish wish{
      .name = line.at("fault").get<std::string>(), .device = line.value("device", ""), .numbers = {}, .names = {}};
  for (const auto& [key, value] : line.items()) {
    if (key == "fault" || key == "device" || key == "on") continue;
    if (value.is_number())
      wish.numbers.emplace_back(key, value.get<double>());
    else
      wish.names.emplace_back(key, value.get<std::string>());
  }
  return wish;
}

// A refusal repeats what was sent, which need not be UTF-8.
std::string text_of(const json& answer) {
  return answer.dump(-1, ' ', false, json::error_handler_t::replace);
}

json report_of(const PlannedFault& fault) {
  const FaultTraits& kind = traits(fault.kind);
  json report{{"fault", kind.name},
              {"device", kFaultDeviceNames[static_cast<std::size_t>(kind.device)]},
              {"moment", kFaultMomentNames[static_cast<std::size_t>(kind.moment)]},
              {"at_s", fault.at_s},
              {"times", fault.times}};
  if (fault.after) report["after"] = *fault.after;
  for (const FaultParameterTraits& p : kFaultParameterTable) {
    if (!kind.parameters.has(p.parameter)) continue;
    const std::string key(p.key);
    if (p.parameter == FaultParameter::Axis)
      report[key] = stage::axis_name(fault.axis());
    else if (p.parameter == FaultParameter::Exchange)
      report[key] = kExchangeNames[static_cast<std::size_t>(fault.exchange())];
    else if (p.parameter == FaultParameter::Role)
      report[key] = kFaultRoleNames[static_cast<std::size_t>(fault.role())];
    else if (fault.values[p.parameter] < kUntilOff)
      report[key] = fault.values[p.parameter];
  }
  return report;
}

json fault_report(LiveInstrument& instrument) {
  return instrument.with([](LiveInstrument::Parts& parts) {
    json faults = json::object();
    for (const FaultTraits& kind : kFaultTable) {
      const FaultCount count = parts.instrument.faults().count(kind.kind, parts.now);
      if (count.armed == 0 && count.fired == 0) continue;
      faults[std::string(kind.name)] = {{"armed", count.armed}, {"fired", count.fired}, {"active", count.is_active}};
    }
    return json{{"ok", true}, {"faults", faults}};
  });
}

json set_fault(const json& line, LiveInstrument& instrument, const StageWire& stage) {
  const auto fault = planned_fault(wish_of(line));
  if (!fault) return refusal(describe(fault.error()));
  if (!stage.can_have(fault->kind)) {
    return refusal(fmt::format("the stage's wire of this run has no \"{}\"", traits(fault->kind).name));
  }
  const bool is_on = line.value("on", true);
  const auto fits = check_fault(*fault, instrument.scene());
  if (is_on && !fits) return refusal(describe(fits.error()));
  return instrument.with([&](LiveInstrument::Parts& parts) -> json {
    if (!is_on) {
      parts.instrument.end_fault(fault->kind, parts.now);
      return {{"ok", true}, {"off", traits(fault->kind).name}};
    }
    if (!parts.instrument.arm(*fault, parts.now)) {
      return refusal(fmt::format("{} faults are armed already", FaultDesk::kMostArmed));
    }
    return {{"ok", true}, {"armed", report_of(*fault)}};
  });
}

json answer_line(const json& line, LiveInstrument& instrument, const StageWire& stage) {
  if (line.contains("fault")) return set_fault(line, instrument, stage);
  const std::string query = line.value("query", "");
  if (query == "stage") return stage_report(instrument);
  if (query == "exposures") return exposure_report(instrument);
  if (query == "faults") return fault_report(instrument);
  return refusal(fmt::format("there is no query \"{}\"", query));
}

}  // namespace

std::string answer_control(const std::string& line, LiveInstrument& instrument, const StageWire& stage) {
  try {
    return text_of(answer_line(json::parse(line), instrument, stage));
  } catch (const json::exception& trouble) {
    return text_of(refusal(trouble.what()));
  }
}

}  // namespace gonio::sim
