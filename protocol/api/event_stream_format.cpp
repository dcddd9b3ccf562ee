#include "protocol/api/event_stream_format.h"

#include "protocol/api/json.h"

namespace gonio::api {

std::string to_event_stream(const Event& event) {
  return "id: " + std::to_string(event.number) + "\nevent: " + event.kind + "\ndata: " + to_json(event) + "\n\n";
}

void EventStreamReader::feed(std::string_view bytes) {
  constexpr std::size_t kLongestBlock = 1U << 20U;
  if (pending_.size() + bytes.size() > kLongestBlock) pending_.clear();
  pending_ += bytes;
}

std::optional<Event> EventStreamReader::next() {
  for (std::size_t end = pending_.find('\n'); end != std::string::npos; end = pending_.find('\n')) {
    const std::string line = pending_.substr(0, end);
    pending_.erase(0, end + 1);
    if (!line.empty()) {
      take_line(line);
      continue;
    }
    const std::string data = std::move(data_);
    data_.clear();
    if (data.empty()) continue;
    Result<Event> event = report_from_json<Event>(data);
    if (event) return std::move(event).value();
  }
  return std::nullopt;
}

void EventStreamReader::take_line(std::string_view line) {
  constexpr std::string_view kData = "data:";
  if (!line.starts_with(kData)) return;
  line.remove_prefix(kData.size());
  if (line.starts_with(' ')) line.remove_prefix(1);
  data_ += line;
}

}  // namespace gonio::api
