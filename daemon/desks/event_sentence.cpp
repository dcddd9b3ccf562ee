#include "daemon/desks/event_sentence.h"

#include <algorithm>

#include "daemon/store/event_facts.h"

namespace gonio::daemon {

std::string event_sentence(const EventRecord& event) {
  std::string kind = event.kind;
  std::ranges::replace(kind, '-', ' ');
  std::string sentence = event.scan == 0 ? kind : "scan " + std::to_string(event.scan) + ": " + kind;
  sentence += " by " + event.who;
  const std::string facts = event_facts(event.json);
  return facts.empty() ? sentence : sentence + " (" + facts + ")";
}

}  // namespace gonio::daemon
