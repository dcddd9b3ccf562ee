#pragma once

#include <string>
#include <string_view>

namespace gonio::daemon {

/// What an event's JSON tells, in words: "hold lamp, owner monitor, reason 0.1 is below 0.2". Lists and nested values
/// are left out; the store has them. Empty where nothing is left.
[[nodiscard]] std::string event_facts(std::string_view event_json);

}  // namespace gonio::daemon
