#include "cli/daemon_client.h"

#include <poll.h>

#include "protocol/api/event_stream_format.h"

namespace gonio::cli {
namespace {

constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::seconds kStopPatience{10};
constexpr std::chrono::seconds kForever{0};  // motion by hand: the daemon has the deadline
constexpr int kMostFailuresInARow = 20;
constexpr int kBetweenFailuresMs = 500;

std::string path_of(api::RouteId id, std::int64_t scan, const std::string& query) {
  std::string path(api::route(id).path);
  if (const std::size_t at = path.find('{'); at != std::string::npos) {
    path.replace(at, path.find('}') + 1 - at, std::to_string(scan));
  }
  return query.empty() ? path : path + "?" + query;
}

std::chrono::seconds patience(api::RouteId id) {
  if (id == api::RouteId::Stop) return kStopPatience;
  const bool waits = id == api::RouteId::StageMove || id == api::RouteId::StageHome || id == api::RouteId::ScanExport ||
                     id == api::RouteId::AnalysisFile || id == api::RouteId::CalibrationMap;
  return waits ? kForever : kPatience;
}

Result<std::string> body_of(Result<HttpReply> reply) {
  constexpr int kSuccess = 200;
  if (!reply) return failure(reply.error());
  if (reply->status != kSuccess) return failure(api::error_from_problem(reply->status, reply->body));
  return std::move(reply->body);
}

}  // namespace

Result<std::string> DaemonClient::fetch(api::RouteId id, std::int64_t scan, const std::string& query) {
  return body_of(http_.get(path_of(id, scan, query), patience(id)));
}

Result<std::string> DaemonClient::send(api::RouteId id, std::int64_t scan, const std::string& body,
                                       const std::map<std::string, std::string>& headers) {
  return body_of(http_.post(path_of(id, scan, {}), body, headers, patience(id)));
}

Result<void> DaemonClient::events(std::int64_t after, const std::function<bool(const api::Event&)>& take) {
  for (int failures = 0;;) {
    api::EventStreamReader reader;
    bool enough = false;
    const Result<HttpReply> reply = http_.stream(
        path_of(api::RouteId::Events, 0, {}), {{"Last-Event-ID", std::to_string(after)}}, [&](std::string_view bytes) {
          failures = 0;
          reader.feed(bytes);
          while (!enough) {
            const std::optional<api::Event> event = reader.next();
            if (!event) break;
            after = event->number;
            enough = !take(*event);
          }
          return !enough;
        });
    if (enough) return {};
    if (reply) return failure(api::error_from_problem(reply->status, reply->body));
    if (reply.error().code != ErrorCode::NoDaemon || ++failures > kMostFailuresInARow) return failure(reply.error());
    poll(nullptr, 0, kBetweenFailuresMs);
  }
}

}  // namespace gonio::cli
