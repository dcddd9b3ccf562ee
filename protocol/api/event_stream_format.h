#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/api/reports.h"

namespace gonio::api {

/// One event as server-sent text: id, event, and the whole event as JSON on one `data` line.
[[nodiscard]] std::string to_event_stream(const Event& event);

/// Takes server-sent events out of bytes as they come (WHATWG HTML, 9.2.6; comments and unknown fields are passed
/// over). A block longer than 1 MiB is dropped. Threads: one.
class EventStreamReader {
 public:
  void feed(std::string_view bytes);
  /// The next whole event; blocks without data give none.
  [[nodiscard]] std::optional<Event> next();

 private:
  void take_line(std::string_view line);
  std::string pending_;
  std::string data_;
};

}  // namespace gonio::api
