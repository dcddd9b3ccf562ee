// What a client sends and what it takes: the head of a request, JSON bodies, problem+json, server-sent events.
#include <algorithm>
#include <string>

#include "daemon/http/request_guard.h"
#include "daemon/http/router.h"
#include "protocol/api/event_stream_format.h"
#include "protocol/api/json.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

template <class T>
void check_request(std::string_view text) {
  const auto request = api::request_from_json<T>(text);
  if (!request) hold_error(request.error());
}

template <class T>
void check_report(std::string_view text) {
  const auto report = api::report_from_json<T>(text);
  if (!report) {
    hold_error(report.error());
    return;
  }
  const std::string written = api::to_json(*report);
  const auto same = api::report_from_json<T>(written);
  hold(same && api::to_json(*same) == written, "a report that is written reads back: " + written);
}

void check_bodies(std::string_view text) {
  check_request<api::PlanSubmission>(text);
  check_request<api::ResumeRequest>(text);
  check_request<api::ChangeRequest>(text);
  check_request<api::MoveRequest>(text);
  check_request<api::PauseRequest>(text);
  check_request<api::NoWords>(text);
  check_report<api::StatusReport>(text);
  check_report<api::PlanReport>(text);
  check_report<api::BrdfPage>(text);
  // Once written it is UTF-8.
  const Error error = api::error_from_problem(422, api::to_problem_json(api::error_from_problem(422, text), 422));
  const Error same = api::error_from_problem(422, api::to_problem_json(error, 422));
  hold(same == error, "a problem that is written reads back: " + describe(error));
}

// Lines "name: value" up to an empty one, then the body's first words do not matter here.
daemon::HttpRequest head_of(std::string_view text) {
  daemon::HttpRequest request;
  const auto line = [&text] {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view first = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return first;
  };
  request.method = line();
  request.path = line();
  while (!text.empty()) {
    const std::string_view header = line();
    const std::size_t colon = std::min(header.find(':'), header.size());
    request.headers[std::string(header.substr(0, colon))] = header.substr(std::min(colon + 1, header.size()));
  }
  return request;
}

void check_head(std::string_view text) {
  static const daemon::RequestGuard guard(8080);
  const daemon::HttpRequest request = head_of(text);
  const daemon::RouteMatch match = daemon::find_route(request.method, request.path);
  if (match.route == nullptr) return;
  hold(match.route->method == (request.method == "POST" ? api::Method::Post : api::Method::Get),
       "a route is of the method asked for");
  hold(match.scan >= 0, "a scan's number is not negative");
  const auto allowed = guard.check(request, *match.route, api::Permission::Operator);
  if (!allowed) {
    hold_device_error(allowed.error());
    return;
  }
  const std::string host = request.header("host");
  hold(host.size() > 5 && host.ends_with(":8080"), "only our own names are served");
  const std::string length = request.header("content-length");
  const bool is_long = length.size() > 7 && std::ranges::all_of(length, [](char c) { return c >= '1' && c <= '9'; });
  hold(!is_long, "a body that is declared too long is refused: " + length);
}

void check_events(Bytes input) {
  ByteSource source(input);
  api::EventStreamReader reader;
  while (!source.is_empty()) {
    reader.feed(text_of(source.counted()));
    while (const auto event = reader.next()) {
      api::EventStreamReader again;
      again.feed(api::to_event_stream(*event));
      const auto same = again.next();
      hold(same && same->number == event->number && same->kind == event->kind, "an event that is written reads back");
    }
  }
}

}  // namespace

void api_text(Bytes input) {
  ByteSource source(input);
  const std::uint8_t what = source.byte();
  if (what % 4 == 0) return check_events(source.rest());
  const std::string_view text = text_of(source.rest());
  if (what % 4 == 1) return check_head(text);
  check_bodies(text);
}

}  // namespace gonio::fuzz
