#include "daemon/store/event_facts.h"

#include <nlohmann/json.hpp>

namespace gonio::daemon {

std::string event_facts(std::string_view event_json) {
  const nlohmann::json data = nlohmann::json::parse(event_json, nullptr, false);
  std::string facts;
  if (!data.is_object()) return facts;
  for (const auto& [name, value] : data.items()) {
    if (value.is_structured() || value.is_null()) continue;
    facts += (facts.empty() ? "" : ", ") + name + " " + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return facts;
}

}  // namespace gonio::daemon
