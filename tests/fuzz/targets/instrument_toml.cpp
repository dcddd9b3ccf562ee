// instrument.toml: what is taken lies within its ranges, and the register map writes itself back.
#include <cmath>

#include "base/toml_reader.h"
#include "daemon/config/instrument.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

const std::string kFile = "instrument.toml";

void hold_axes(const drivers::StageConfig& stage) {
  for (const stage::Axis axis : stage::kAllAxes) {
    const drivers::AxisConfig& one = stage.axis(axis);
    hold(std::isfinite(one.low) && std::isfinite(one.high) && one.low < one.high, "limits are finite and in order");
    hold(one.speed > 0.0 && one.acceleration > 0.0 && std::isfinite(one.speed), "an axis moves");
    hold(one.settle >= Duration::zero(), "settling takes no negative time");
    hold(drivers::counts_of(stage, axis, one.low) != drivers::counts_of(stage, axis, one.high) ||
             std::abs(stage.registers.axis_scale[stage::index_of(axis)]) > one.high - one.low,
         "counts tell the limits apart");
  }
  hold(stage.reply_timeout > Duration::zero() && stage.heartbeat_timeout > Duration::zero(), "timeouts are positive");
}

void hold_register_map(const stage::RegisterMap& map) {
  const std::string text = stage::to_toml(map, "registers");
  auto root = TomlReader::parse(text, kFile);
  hold(root.has_value(), "a register map is written as TOML");
  TomlReader table = root->table("registers");
  const stage::RegisterMap same = stage::read_register_map(table);
  hold(root->finish().has_value() && same == map, "a register map that is written reads back");
  hold(map.status_block().count <= 125, "the status block is read at once");
}

}  // namespace

void instrument_toml(Bytes input) {
  const std::string_view text = text_of(input);
  const auto instrument = daemon::parse_instrument(text, kFile);
  if (!instrument) {
    hold_input_error(instrument.error(), kFile, text);
    return;
  }
  hold_axes(instrument->stage);
  hold_register_map(instrument->stage.registers);
  hold(!instrument->filters.empty() && instrument->sha256.size() == 64, "an instrument has a filter and a hash");
  hold(instrument->detector.shortest_exposure > Duration::zero() &&
           instrument->detector.longest_exposure >= instrument->detector.shortest_exposure,
       "exposures are in order");
  const auto again = daemon::parse_instrument(instrument->text, kFile);
  hold(again && again->sha256 == instrument->sha256, "the stored text gives the same hash");
}

}  // namespace gonio::fuzz
