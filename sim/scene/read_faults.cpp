#include "sim/scene/read_faults.h"

#include <string>

namespace gonio::sim {
namespace {

FaultWish read_wish(TomlReader& t) {
  FaultWish wish{.name = t.text("name"), .device = t.text_or("device", ""), .numbers = {}, .names = {}};
  for (const std::string& key : t.keys()) {
    if (key == "name" || key == "device") continue;
    if (t.kind(key) == TomlKind::Number)
      wish.numbers.emplace_back(key, t.number(key));
    else
      wish.names.emplace_back(key, t.text(key));
  }
  return wish;
}

}  // namespace

FaultPlan read_faults(TomlReader& root) {
  FaultPlan plan;
  for (TomlReader& t : root.tables("faults")) {
    const FaultWish wish = read_wish(t);
    if (t.has_failed()) break;
    if (auto fault = planned_fault(wish))
      plan.push_back(*fault);
    else
      t.fail(fault.error().where->field, fault.error().code, fault.error().seen, fault.error().limit);
  }
  return plan;
}

}  // namespace gonio::sim
