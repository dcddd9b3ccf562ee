// The server over a real loopback socket, asked by a client that shares no code with it.
#include "daemon/http/server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <thread>

#include "protocol/api/json.h"
#include "protocol/api/route.h"
#include "tests/daemon/http/fake_service.h"
#include "tests/support/http_client.h"
#include "tests/support/process.h"

namespace gonio::daemon {
namespace {

using test::http_request;
using test::HttpAnswer;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::chrono::seconds kHanging{30};  // bounds a hanging test

class ServerTest : public testing::Test {
 protected:
  void start(const ServerOptions& options = {}, const std::string& socket_file = {}) {
    Result<Listeners> bound = Listeners::bind("127.0.0.1", 0, socket_file);
    ASSERT_TRUE(bound.has_value()) << describe(bound.error());
    Result<std::unique_ptr<Server>> started = Server::start(std::move(*bound), options, service_, clock_);
    ASSERT_TRUE(started.has_value()) << describe(started.error());
    server_ = std::move(*started);
  }
  int port() const { return server_->port(); }
  HttpAnswer post(const std::string& path, const std::string& body, std::map<std::string, std::string> headers = {}) {
    if (!headers.contains("Content-Type")) headers["Content-Type"] = "application/json";
    return http_request(port(), "POST", path, body, headers);
  }
  static Error error_in(const HttpAnswer& answer) {
    EXPECT_EQ(answer.headers.at("content-type"), "application/problem+json") << answer.body;
    return api::error_from_problem(answer.status, answer.body);
  }

  SystemClock clock_;
  test::FakeService service_;
  std::unique_ptr<Server> server_;
};

TEST_F(ServerTest, AnswersStatusAsJson) {
  start();

  const HttpAnswer answer = http_request(port(), "GET", "/api/v1/status");

  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.headers.at("content-type"), "application/json");
  const Result<api::StatusReport> status = api::report_from_json<api::StatusReport>(answer.body);
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(status->instrument, "bench A");
  EXPECT_EQ(status->stage->axes.at(0).position, 30.0);
}

TEST_F(ServerTest, StopsForTheLocalCaller) {
  start();

  const HttpAnswer answer = post("/api/v1/stop", "{}");

  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(api::report_from_json<api::StopReport>(answer.body)->epoch, 7);
  EXPECT_THAT(service_.asked(), ElementsAre("stop local"));
}

TEST_F(ServerTest, StopsWhileEveryOtherRequestWaits) {
  service_.hold_replies = true;
  start();
  std::vector<std::thread> waiting;
  for (int i = 0; i < 4; ++i)
    waiting.emplace_back([this] { (void)post("/api/v1/stage/move", "{\"theta_i_deg\": 3}"); });
  ASSERT_TRUE(test::eventually([&] { return service_.held() == 4; }, kHanging));

  EXPECT_EQ(post("/api/v1/stop", "{}").status, 200);

  service_.answer_held();
  for (std::thread& one : waiting) one.join();
}

TEST_F(ServerTest, AChangingRouteWithoutDeclaredJsonIsRefusedAndNothingHappens) {
  start();
  for (const api::Route& route : api::kRoutes) {
    if (route.method != api::Method::Post) continue;
    std::string path(route.path);
    if (const auto at = path.find('{'); at != std::string::npos) path.replace(at, path.find('}') + 1 - at, "3");

    const HttpAnswer form = post(path, "{}", {{"Content-Type", "text/plain"}});

    EXPECT_EQ(form.status, 415) << path;
    EXPECT_EQ(error_in(form).code, ErrorCode::UnsupportedMediaType);
    EXPECT_EQ(http_request(port(), "POST", path).status, 415) << path;
  }
  EXPECT_THAT(service_.asked(), IsEmpty());
}

TEST_F(ServerTest, AForeignHostIsRefusedOnEveryRoute) {
  start();
  for (const api::Route& route : api::kRoutes) {
    std::string path(route.path);
    if (const auto at = path.find('{'); at != std::string::npos) path.replace(at, path.find('}') + 1 - at, "3");

    const HttpAnswer answer = http_request(port(), std::string(api::method_name(route.method)), path,
                                           route.method == api::Method::Post ? "{}" : "",
                                           {{"Host", "evil.example:" + std::to_string(port())}});

    EXPECT_EQ(answer.status, 403) << route.path;
  }
  EXPECT_THAT(service_.asked(), IsEmpty());
}

TEST_F(ServerTest, AForeignOriginIsRefusedAndOurOwnIsNot) {
  start();
  const std::string own = "http://localhost:" + std::to_string(port());

  const HttpAnswer foreign = post("/api/v1/stop", "{}", {{"Origin", "https://evil.example"}});
  const HttpAnswer no_origin = post("/api/v1/stop", "{}", {{"Origin", "null"}});
  const HttpAnswer ours = post("/api/v1/stop", "{}", {{"Origin", own}});

  EXPECT_EQ(foreign.status, 403);
  EXPECT_EQ(error_in(foreign).code, ErrorCode::ForbiddenOrigin);
  EXPECT_EQ(no_origin.status, 403);
  EXPECT_EQ(ours.status, 200);
  EXPECT_EQ(service_.asked().size(), 1U);
}

TEST_F(ServerTest, AnUnknownPathIsNotFoundAndAWrongMethodNamesTheRightOne) {
  start();

  const HttpAnswer unknown = http_request(port(), "GET", "/api/v1/nothing");
  const HttpAnswer wrong = http_request(port(), "DELETE", "/api/v1/scans");

  EXPECT_EQ(unknown.status, 404);
  EXPECT_EQ(error_in(unknown).code, ErrorCode::NotFound);
  EXPECT_EQ(wrong.status, 405);
  EXPECT_EQ(wrong.headers.at("allow"), "POST, GET");
  EXPECT_EQ(http_request(port(), "GET", "/api/v1/scans/none").status, 404);
  EXPECT_EQ(http_request(port(), "GET", "/api/v1/scans/-3").status, 404);
}

TEST_F(ServerTest, ErrorsOfTheServiceComeAsProblemsWithAllTheirParts) {
  start();

  const HttpAnswer answer = post("/api/v1/plans:check", "{\"plan\": \"theta_i_degg = 1\", \"plan_file\": \"w.toml\"}");

  EXPECT_EQ(answer.status, 422);
  const Error error = error_in(answer);
  EXPECT_EQ(error.code, ErrorCode::UnknownKey);
  EXPECT_EQ(error.where, (InputLocation{"w.toml", 5, "geometry.theta_i_degg"}));
  EXPECT_THAT(error.limit, HasSubstr("theta_i_deg"));
  EXPECT_EQ(post("/api/v1/stage/home", "{}").status, 409);
}

TEST_F(ServerTest, BodiesThatAreNotWhatTheRouteTakesAreRefused) {
  start();

  EXPECT_EQ(post("/api/v1/stage/move", "{\"theta_i\": 3}").status, 422);
  EXPECT_EQ(error_in(post("/api/v1/stage/move", "{\"theta_i_deg\": \"3\"}")).where->field, "theta_i_deg");
  EXPECT_EQ(post("/api/v1/stage/move", "[1]").status, 422);
  EXPECT_EQ(post("/api/v1/stage/move", "{").status, 422);
  EXPECT_EQ(post("/api/v1/scans/3/resume", "{\"now\": true}").status, 422);
  EXPECT_THAT(service_.asked(), IsEmpty());
}

TEST_F(ServerTest, ABodyBeyondTheLimitIsRefused) {
  start();

  const HttpAnswer answer = post("/api/v1/stop", std::string(api::kSmallBody + 1, ' '));

  EXPECT_EQ(answer.status, 413);
  EXPECT_THAT(service_.asked(), IsEmpty());
}

TEST_F(ServerTest, PassesOnWhatCommandsSay) {
  start();

  const HttpAnswer submitted =
      post("/api/v1/scans", "{\"plan\": \"text\", \"plan_file\": \"w.toml\"}", {{"Idempotency-Key", "k1"}});
  (void)post("/api/v1/scans/3/pause", "{\"now\": true, \"reason\": \"lamp\"}");
  (void)post("/api/v1/scans/3/finish", "{}");

  EXPECT_EQ(api::report_from_json<api::CommandReport>(submitted.body)->scan, 3);
  EXPECT_THAT(service_.asked(),
              ElementsAre("submit w.toml [text] key=k1 local", "change 3 verb 1 lamp local", "change 3 verb 2  local"));
}

TEST_F(ServerTest, PagesAreAskedForByTheQuery) {
  start();

  const HttpAnswer answer = http_request(port(), "GET", "/api/v1/scans/3/points?after=41&limit=10");

  const Result<api::PointPage> page = api::report_from_json<api::PointPage>(answer.body);
  ASSERT_TRUE(page.has_value()) << answer.body;
  EXPECT_EQ(page->points.at(0).index, 42);
  EXPECT_EQ(page->next_after, 10);
}

TEST_F(ServerTest, ExportsCsvAndNothingElse) {
  start();

  const HttpAnswer csv = http_request(port(), "GET", "/api/v1/scans/3/export?format=csv");
  const HttpAnswer other = http_request(port(), "GET", "/api/v1/scans/3/export?format=bird");

  EXPECT_EQ(csv.headers.at("content-type"), "text/csv");
  EXPECT_EQ(csv.body, "# scan: 3\npoint,theta_i_deg\n0,30\n");
  EXPECT_EQ(other.status, 422);
}

TEST_F(ServerTest, MetricsCountWhatWasAnswered) {
  start();
  (void)http_request(port(), "GET", "/api/v1/nothing");

  const HttpAnswer answer = http_request(port(), "GET", "/api/v1/metrics");

  EXPECT_THAT(answer.body, HasSubstr("goniod_fake 1\n"));
  EXPECT_THAT(answer.body, HasSubstr("goniod_http_answers_total{class=\"4xx\"} 1\n"));
}

TEST_F(ServerTest, AnAnswerThatNeverComesBecomesATimeout) {
  service_.hold_replies = true;
  start({.most_patience = std::chrono::milliseconds(1)});

  const HttpAnswer answer = post("/api/v1/stage/move", "{\"theta_i_deg\": 3}");

  EXPECT_EQ(answer.status, 504);
  EXPECT_EQ(error_in(answer).code, ErrorCode::TimedOut);
  service_.answer_held();  // too late, and harmless
}

TEST_F(ServerTest, EndsWithRequestsOpenAndClientsListening) {
  service_.hold_replies = true;
  start();
  HttpAnswer answer;
  std::thread waiting([&] { answer = post("/api/v1/stage/move", "{\"theta_i_deg\": 3}"); });
  test::EventReader listener(port(), 0);
  ASSERT_TRUE(test::eventually([&] { return service_.held() == 1 && listener.is_connected(); }, kHanging));

  server_.reset();

  waiting.join();
  EXPECT_THAT(answer.status, testing::AnyOf(0, 503));
}

TEST_F(ServerTest, APortThatIsTakenIsAnError) {
  start();

  const Result<Listeners> second = Listeners::bind("127.0.0.1", server_->port(), "");

  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, ErrorCode::PortBusy);
  EXPECT_THAT(second.error().tried, HasSubstr(std::to_string(port())));
}

TEST_F(ServerTest, AnAddressBeyondLoopbackIsRefused) {
  const Result<Listeners> server = Listeners::bind("0.0.0.0", 0, "");

  ASSERT_FALSE(server.has_value());
  EXPECT_EQ(server.error().code, ErrorCode::NotAuthorised);
  EXPECT_THAT(server.error().limit, HasSubstr("loopback"));
}

// The whole answer to one request on a unix socket.
std::string ask_unix_socket(const std::string& path, const std::string& request) {
  const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  std::string answer;
  if (connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
      write(fd, request.data(), request.size()) == static_cast<ssize_t>(request.size())) {
    char buffer[4096];
    for (ssize_t n = read(fd, buffer, sizeof buffer); n > 0; n = read(fd, buffer, sizeof buffer)) {
      answer.append(buffer, static_cast<std::size_t>(n));
    }
  }
  close(fd);
  return answer;
}

TEST_F(ServerTest, OnTheUnixSocketTheCallerIsKnownByItsUserId) {
  const test::TemporaryFolder folder;
  start({}, folder / "s");

  const std::string answer = ask_unix_socket(folder / "s",
                                             "POST /api/v1/stop HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
                                             "Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}");

  EXPECT_THAT(answer, testing::StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(service_.asked(), ElementsAre("stop uid:" + std::to_string(getuid())));
}

TEST_F(ServerTest, AUnixSocketInUseIsAnErrorAndAnAbandonedOneIsNot) {
  const test::TemporaryFolder folder;
  start({}, folder / "s");

  const Result<Listeners> second = Listeners::bind("127.0.0.1", 0, folder / "s");
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, ErrorCode::PortBusy);

  server_.reset();
  test::write_text(folder / "s", "");
  start({}, folder / "s");
}

}  // namespace
}  // namespace gonio::daemon
