#include "daemon/desks/event_sentence.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace gonio::daemon {

std::string event_sentence(const EventRecord& event) {
  std::string kind = event.kind;
  std::ranges::replace(kind, '-', ' ');
  std::string sentence = event.scan == 0 ? kind : "scan " + std::to_string(event.scan) + ": " + kind;
  sentence += " by " + event.who;
  const nlohmann::json data = nlohmann::json::parse(event.json, nullptr, false);
  if (!data.is_object()) return sentence;
  std::string facts;
  for (const auto& [name, value] : data.items()) {
    if (value.is_structured() || value.is_null()) continue;
    facts += (facts.empty() ? "" : ", ") + name + " " + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return facts.empty() ? sentence : sentence + " (" + facts + ")";
}

}  // namespace gonio::daemon
