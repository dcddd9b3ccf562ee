#include "daemon/http/gateway.h"

#include <fmt/format.h>

#include <charconv>

#include "protocol/api/json.h"

namespace gonio::daemon {
namespace {

using api::RouteId;

constexpr std::size_t kMostRequestsWaiting = 64;
constexpr int kPage = 1000;

HttpResponse success(std::string_view content_type, std::string body) {
  return {.status = 200, .content_type = std::string(content_type), .body = std::move(body)};
}

template <class T>
HttpResponse json_response(const Result<T>& result) {
  return result ? success(api::kJson, api::to_json(*result)) : problem(result.error());
}

template <class T>
Reply<T> reply_to(const std::shared_ptr<Exchange>& exchange) {
  return [exchange](Result<T> result) { exchange->answer(json_response(result)); };
}

// A whole number of the query; the fallback when it is not there or is none.
std::int64_t number_in_query(const HttpRequest& request, const std::string& name, std::int64_t fallback) {
  const auto found = request.query.find(name);
  if (found == request.query.end()) return fallback;
  std::int64_t value = fallback;
  const std::string& text = found->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : fallback;
}

bool is_slow(RouteId id) {
  return id == RouteId::PlanCheck || id == RouteId::ScanSubmit || id == RouteId::ScanBrdf ||
         id == RouteId::ScanExport || id == RouteId::ScanOne || id == RouteId::ScanCompleteMissing ||
         id == RouteId::ScanRecompute || id == RouteId::CalibrationChart || id == RouteId::AnalysisFile ||
         id == RouteId::ReferenceImport || id == RouteId::ReferenceCheck || id == RouteId::ScanChecks ||
         id == RouteId::ScanBudget || id == RouteId::CalibrationMap;
}

HttpResponse no_such_route(const HttpRequest& request, const RouteMatch& match) {
  Error error{.code = ErrorCode::NotFound,
              .device = "http",
              .tried = request.method + " " + request.path,
              .seen = "there is no such route",
              .limit = {}};
  if (match.allowed.empty()) return problem(error);
  constexpr int kMethodNotAllowed = 405;
  error.seen = "the path does not take " + request.method;
  error.limit = match.allowed;
  HttpResponse response = problem(error, kMethodNotAllowed);
  response.headers.emplace_back("Allow", match.allowed);
  return response;
}

struct Words {
  ScanVerb verb = ScanVerb::Pause;
  std::string reason;
};

Result<Words> scan_words(RouteId id, const std::string& body) {
  if (id == RouteId::ScanPause) {
    const Result<api::PauseRequest> pause = api::request_from_json<api::PauseRequest>(body);
    if (!pause) return failure(pause.error());
    return Words{pause->now ? ScanVerb::PauseNow : ScanVerb::Pause, pause->reason};
  }
  if (id == RouteId::ScanAbort) {
    const Result<api::AbortRequest> abort = api::request_from_json<api::AbortRequest>(body);
    if (!abort) return failure(abort.error());
    return Words{ScanVerb::Abort, abort->reason};
  }
  GONIO_TRY(api::request_from_json<api::NoWords>(body));
  return Words{id == RouteId::ScanFinish ? ScanVerb::Finish : ScanVerb::Skip, {}};
}

}  // namespace

Gateway::Gateway(Service& service, const EventHub& hub, std::uint16_t port)
    : service_(service), hub_(hub), guard_(port), quick_(kMostRequestsWaiting), slow_(kMostRequestsWaiting) {}

std::optional<HttpResponse> Gateway::refusal(const HttpRequest& request, const RouteMatch& match) const {
  if (match.route == nullptr) return no_such_route(request, match);
  // Loopback and the unix socket: whoever gets there is the operator.
  const Result<void> checked = guard_.check(request, *match.route, api::Permission::Operator);
  if (!checked) return problem(checked.error());
  return std::nullopt;
}

void Gateway::answer(HttpRequest request, const RouteMatch& match, const std::shared_ptr<Exchange>& exchange) {
  if (match.route->id == RouteId::Stop) {
    service_.stop(request.who, reply_to<api::StopReport>(exchange));
    return;
  }
  Worker& lane = is_slow(match.route->id) ? slow_ : quick_;
  auto job = [this, request = std::move(request), match, exchange] { run(request, match, exchange); };
  if (lane.post(std::move(job))) return;
  exchange->answer(problem({.code = ErrorCode::Busy,
                            .device = "http",
                            .tried = "take on a request",
                            .seen = fmt::format("{} requests wait already", kMostRequestsWaiting),
                            .limit = {}}));
}

Duration Gateway::patience(RouteId route) {
  constexpr Duration kMotion = std::chrono::minutes(10);  // homing by hand; the engine has its own, computed, deadline
  constexpr Duration kStop = std::chrono::seconds(10);
  constexpr Duration kOther = std::chrono::minutes(1);
  if (route == RouteId::StageMove || route == RouteId::StageHome) return kMotion;
  return route == RouteId::Stop ? kStop : kOther;
}

void Gateway::count(const HttpResponse& response) {
  const auto digit = static_cast<std::size_t>(response.status / 100);
  if (digit < answers_.size()) ++answers_[digit];
}

void Gateway::run(const HttpRequest& request, const RouteMatch& match, const std::shared_ptr<Exchange>& exchange) {
  if (match.route->changes) {
    run_command(request, match, exchange);
  } else {
    exchange->answer(read(request, match));
  }
}

void Gateway::run_command(const HttpRequest& request, const RouteMatch& match,
                          const std::shared_ptr<Exchange>& exchange) {
  const auto reply = reply_to<api::CommandReport>(exchange);
  const auto refused = [&](const Error& error) { exchange->answer(problem(error)); };
  switch (match.route->id) {
    case RouteId::StageMove: {
      const Result<api::MoveRequest> move = api::request_from_json<api::MoveRequest>(request.body);
      return move ? service_.move_stage(*move, request.who, reply) : refused(move.error());
    }
    case RouteId::DetectorRead: {
      const auto read = api::request_from_json<api::DetectorReadRequest>(request.body);
      if (!read) return refused(read.error());
      return service_.read_detector(*read, request.who, reply_to<api::DetectorReading>(exchange));
    }
    case RouteId::StageHome:
      return service_.home_stage(request.who, reply);
    case RouteId::StageReset:
      return service_.reset_stage(request.who, reply);
    case RouteId::ScanSubmit: {
      const Result<api::PlanSubmission> plan = api::request_from_json<api::PlanSubmission>(request.body);
      if (!plan) return refused(plan.error());
      return service_.submit_scan(*plan, request.header("idempotency-key"), request.who, reply);
    }
    case RouteId::ScanResume: {
      const Result<api::ResumeRequest> resume = api::request_from_json<api::ResumeRequest>(request.body);
      return resume ? service_.resume_scan(match.scan, *resume, request.who, reply) : refused(resume.error());
    }
    case RouteId::ScanChange: {
      const Result<api::ChangeRequest> change = api::request_from_json<api::ChangeRequest>(request.body);
      return change ? service_.change_rest(match.scan, *change, request.who, reply) : refused(change.error());
    }
    case RouteId::CalibrationUse: {
      const auto use = api::request_from_json<api::UseCalibrationRequest>(request.body);
      return use ? service_.use_calibration(match.scan, *use, request.who, reply) : refused(use.error());
    }
    case RouteId::ScanRecompute: {
      const auto recompute = api::request_from_json<api::RecomputeRequest>(request.body);
      return recompute ? service_.recompute_scan(match.scan, *recompute, request.who, reply)
                       : refused(recompute.error());
    }
    case RouteId::ScanCompleteMissing:
      return service_.complete_missing(match.scan, request.who, reply);
    case RouteId::AnalysisStart: {
      const auto job = api::request_from_json<api::AnalysisRequest>(request.body);
      if (!job) return refused(job.error());
      return exchange->answer(json_response(service_.start_analysis(*job, request.who)));
    }
    case RouteId::AnalysisCancel: {
      const auto words = api::request_from_json<api::NoWords>(request.body);
      if (!words) return refused(words.error());
      return exchange->answer(json_response(service_.cancel_analysis(match.scan)));
    }
    case RouteId::ReferenceImport: {
      const auto reference = api::request_from_json<api::ReferenceImport>(request.body);
      if (!reference) return refused(reference.error());
      return exchange->answer(json_response(service_.import_reference(*reference, request.who)));
    }
    default: {
      const Result<Words> words = scan_words(match.route->id, request.body);
      if (!words) return refused(words.error());
      return service_.change_scan(match.scan, words->verb, words->reason, request.who, reply);
    }
  }
}

HttpResponse Gateway::read(const HttpRequest& request, const RouteMatch& match) {
  const std::int64_t after = number_in_query(request, "after", -1);
  const int at_most =
      static_cast<int>(std::clamp<std::int64_t>(number_in_query(request, "limit", kPage), 1, 5 * kPage));
  switch (match.route->id) {
    case RouteId::Status:
      return json_response(service_.status());
    case RouteId::Health:
      return success(api::kJson, api::to_json(service_.health()));
    case RouteId::Metrics:
      return success(api::kMetricsText, metrics());
    case RouteId::Stage:
      return json_response(service_.stage());
    case RouteId::PlanCheck: {
      const Result<api::PlanSubmission> plan = api::request_from_json<api::PlanSubmission>(request.body);
      return plan ? json_response(service_.check_plan(*plan)) : problem(plan.error());
    }
    case RouteId::ScanList:
      return json_response(service_.scans());
    case RouteId::ScanOne:
      return json_response(service_.scan(match.scan));
    case RouteId::ScanPoints:
      return json_response(service_.points(match.scan, after, at_most));
    case RouteId::ScanBrdf:
      return json_response(service_.brdf(match.scan, after, at_most));
    case RouteId::ScanExport: {
      const auto format = request.query.find("format");
      if (format != request.query.end() && format->second != "csv") {
        return problem({.code = ErrorCode::InvalidInput,
                        .tried = "export the scan",
                        .seen = "format \"" + format->second + "\"",
                        .limit = "csv",
                        .where = InputLocation{"", 0, "format"}});
      }
      Result<std::string> csv = service_.export_csv(match.scan);
      return csv ? success(api::kCsv, std::move(csv).value()) : problem(csv.error());
    }
    case RouteId::Calibrations:
      return json_response(service_.calibrations());
    case RouteId::CalibrationOne:
      return json_response(service_.calibration(match.scan));
    case RouteId::CalibrationMap: {
      const auto name = request.query.find("name");
      Result<std::string> bytes = service_.calibration_map(match.scan, name == request.query.end() ? "" : name->second);
      return bytes ? success(api::kBytes, std::move(bytes).value()) : problem(bytes.error());
    }
    case RouteId::CalibrationChart: {
      const auto standard = request.query.find("standard");
      return json_response(service_.calibration_chart(standard == request.query.end() ? "" : standard->second));
    }
    case RouteId::AnalysisList:
      return success(api::kJson, api::to_json(service_.analyses()));
    case RouteId::AnalysisOne:
      return json_response(service_.analysis(match.scan));
    case RouteId::AnalysisFile: {
      const auto name = request.query.find("name");
      Result<std::string> bytes = service_.analysis_file(match.scan, name == request.query.end() ? "" : name->second);
      return bytes ? success(api::kBytes, std::move(bytes).value()) : problem(bytes.error());
    }
    case RouteId::ScanChecks:
      return json_response(service_.checks(match.scan));
    case RouteId::ScanBudget: {
      const bool is_asked = request.query.contains("point");
      const std::int64_t point = number_in_query(request, "point", -1);
      return json_response(service_.budget(match.scan, is_asked ? std::optional(point) : std::nullopt));
    }
    case RouteId::ReferenceCheck: {
      const auto reference = api::request_from_json<api::ReferenceImport>(request.body);
      return reference ? json_response(service_.check_reference(*reference)) : problem(reference.error());
    }
    case RouteId::ReferenceOne: {
      const auto serial = request.query.find("serial");
      return json_response(service_.reference(serial == request.query.end() ? std::string() : serial->second));
    }
    case RouteId::Instrument:
      return success(api::kJson, api::to_json(service_.instrument()));
    default:
      return json_response(service_.references());
  }
}

std::string Gateway::metrics() const {
  std::string text = service_.metrics();
  text += "# HELP goniod_http_answers_total Answers by the first digit of their status.\n";
  text += "# TYPE goniod_http_answers_total counter\n";
  for (std::size_t digit = 2; digit < answers_.size(); ++digit) {
    text += fmt::format("goniod_http_answers_total{{class=\"{}xx\"}} {}\n", digit, answers_[digit].load());
  }
  text += fmt::format("# TYPE goniod_event_clients gauge\ngoniod_event_clients {}\n", hub_.clients());
  text +=
      fmt::format("# TYPE goniod_events_published_total counter\ngoniod_events_published_total {}\n", hub_.published());
  text += "# HELP goniod_event_clients_dropped_total Clients that read too slowly.\n";
  text += fmt::format("# TYPE goniod_event_clients_dropped_total counter\ngoniod_event_clients_dropped_total {}\n",
                      hub_.dropped());
  return text;
}

}  // namespace gonio::daemon
