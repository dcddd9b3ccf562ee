#include "daemon/http/server.h"

#include <microhttpd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <condition_variable>
#include <list>
#include <mutex>
#include <thread>

#include "daemon/http/gateway.h"
#include "daemon/http/listening_socket.h"

namespace gonio::daemon {
namespace {

constexpr unsigned kMostConnections = 512;
constexpr unsigned kSilentSeconds = 60;  // a connection without traffic; suspended ones do not count
constexpr std::size_t kConnectionMemory = 32U << 10U;
constexpr std::size_t kEventBlock = 16U << 10U;

MHD_Result add_field(void* fields, MHD_ValueKind, const char* key, const char* value) {
  std::string name = key;
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static_cast<std::map<std::string, std::string>*>(fields)->insert_or_assign(name, value == nullptr ? "" : value);
  return MHD_YES;
}

int descriptor_of(MHD_Connection* connection) {
  return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
}

std::optional<std::int64_t> whole_number(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

// One request under way, from its first header to the last byte of its answer. Lives on the event thread.
struct Call {
  HttpRequest request;
  RouteMatch match;
  std::optional<HttpResponse> refusal;
  std::shared_ptr<Exchange> exchange;
};

// What an event stream's content reader needs.
struct Listener {
  EventHub* hub = nullptr;
  std::shared_ptr<EventClient> client;
};

ssize_t read_events(void* cls, std::uint64_t, char* buffer, std::size_t size) {
  auto* listener = static_cast<Listener*>(cls);
  bool needs_more = false;
  const std::ptrdiff_t n = listener->client->read({buffer, size}, needs_more);
  if (needs_more) listener->hub->catch_up(listener->client);
  return n < 0 ? static_cast<ssize_t>(MHD_CONTENT_READER_END_OF_STREAM) : n;
}

void end_events(void* cls) {
  auto* listener = static_cast<Listener*>(cls);
  listener->client->close();
  delete listener;
}

// Takes the body in, bounded. What is beyond the limit is read and thrown away, so that the client gets to the answer.
void take_body(Call& call, std::string_view bytes) {
  if (call.refusal) return;
  if (call.request.body.size() + bytes.size() <= call.match.route->body_limit) {
    call.request.body += bytes;
    return;
  }
  call.request.body.clear();
  call.refusal = problem({.code = ErrorCode::TooLarge,
                          .device = "http",
                          .tried = "read the request's body",
                          .seen = "more than the limit",
                          .limit = std::to_string(call.match.route->body_limit) + " bytes"});
}

class MicroHttpServer final : public Server {
 public:
  MicroHttpServer(const ServerOptions& options, Service& service, const Clock& clock, std::uint16_t port,
                  std::string socket_file)
      : options_(options),
        clock_(clock),
        port_(port),
        socket_file_(std::move(socket_file)),
        hub_([&service](std::int64_t after, int at_most) { return service.events(after, at_most); }, options.last_event,
             options.event_client_limit_bytes),
        gateway_(service, hub_, port) {}

  ~MicroHttpServer() override {
    stop_housekeeping();
    hub_.close();
    refuse_all_open();
    for (MHD_Daemon* daemon : daemons_) MHD_stop_daemon(daemon);
    if (!socket_file_.empty()) unlink(socket_file_.c_str());
  }

  Result<void> serve(ListeningSocket socket) {
    const int descriptor = socket.give_away();
    MHD_Daemon* daemon = MHD_start_daemon(
        MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr, &MicroHttpServer::on_request,
        this, MHD_OPTION_LISTEN_SOCKET, descriptor, MHD_OPTION_CONNECTION_LIMIT, kMostConnections,
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionMemory, MHD_OPTION_CONNECTION_TIMEOUT, kSilentSeconds,
        MHD_OPTION_NOTIFY_COMPLETED, &MicroHttpServer::on_completed, this, MHD_OPTION_END);
    if (daemon == nullptr) {
      close(descriptor);
      return failure({.code = ErrorCode::Internal,
                      .device = "http",
                      .tried = "start the event thread",
                      .seen = "libmicrohttpd refused",
                      .limit = {}});
    }
    daemons_.push_back(daemon);
    return {};
  }

  void start_housekeeping() {
    housekeeper_ = std::thread([this] { keep_house(); });
  }

  std::uint16_t port() const override { return port_; }
  void publish(const api::Event& event) override { hub_.publish(event); }

 private:
  struct Open {
    Instant deadline;
    std::shared_ptr<Exchange> exchange;
  };

  static MHD_Result on_request(void* cls, MHD_Connection* connection, const char* url, const char* method, const char*,
                               const char* upload, std::size_t* upload_size, void** slot) {
    auto* self = static_cast<MicroHttpServer*>(cls);
    if (*slot == nullptr) {
      *slot = self->begin(connection, method, url);
      return MHD_YES;
    }
    auto& call = *static_cast<Call*>(*slot);
    if (*upload_size > 0) {
      take_body(call, {upload, *upload_size});
      *upload_size = 0;
      return MHD_YES;
    }
    return self->go_on(connection, call);
  }

  static void on_completed(void*, MHD_Connection*, void** slot, MHD_RequestTerminationCode) {
    delete static_cast<Call*>(*slot);
    *slot = nullptr;
  }

  Call* begin(MHD_Connection* connection, const char* method, const char* url) {
    auto call = std::make_unique<Call>();
    call->request.method = method;
    call->request.path = url;
    call->request.who = peer_name(descriptor_of(connection));
    call->request.by_unix_socket = call->request.who != "local";
    MHD_get_connection_values(connection, MHD_HEADER_KIND, &add_field, &call->request.headers);
    MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, &add_field, &call->request.query);
    call->match = find_route(call->request.method, call->request.path);
    call->refusal = gateway_.refusal(call->request, call->match);
    return call.release();
  }

  // The request is there whole: answered at once, listened to, or started and suspended until its answer is there.
  MHD_Result go_on(MHD_Connection* connection, Call& call) {
    if (call.refusal) return send(connection, *call.refusal);
    if (call.match.route->id == api::RouteId::Events) return send_events(connection, call);
    if (call.exchange) return call.exchange->is_answered() ? send(connection, call.exchange->response()) : MHD_YES;
    MHD_suspend_connection(connection);
    call.exchange = std::make_shared<Exchange>([connection] { MHD_resume_connection(connection); });
    if (remember(call.exchange, Gateway::patience(call.match.route->id))) {
      gateway_.answer(std::move(call.request), call.match, call.exchange);
    }
    return MHD_YES;
  }

  // False: the server is ending, and the exchange has its answer.
  bool remember(const std::shared_ptr<Exchange>& exchange, Duration patience) {
    const std::lock_guard lock(mutex_);
    if (stopping_) {
      exchange->answer(ending());
      return false;
    }
    open_.push_back({clock_.now() + std::min(patience, options_.most_patience), exchange});
    return true;
  }

  MHD_Result send(MHD_Connection* connection, const HttpResponse& answer) {
    gateway_.count(answer);
    // The call keeps the body until the answer is complete: nothing is copied.
    MHD_Response* response = MHD_create_response_from_buffer(answer.body.size(), const_cast<char*>(answer.body.data()),
                                                             MHD_RESPMEM_PERSISTENT);
    MHD_add_response_header(response, "Content-Type", answer.content_type.c_str());
    MHD_add_response_header(response, "Cache-Control", "no-store");
    MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
    for (const auto& [name, value] : answer.headers) MHD_add_response_header(response, name.c_str(), value.c_str());
    const MHD_Result queued = MHD_queue_response(connection, static_cast<unsigned>(answer.status), response);
    MHD_destroy_response(response);
    return queued;
  }

  MHD_Result send_events(MHD_Connection* connection, const Call& call) {
    std::optional<std::int64_t> after = whole_number(call.request.header("last-event-id"));
    const auto asked = call.request.query.find("after");
    if (!after && asked != call.request.query.end()) after = whole_number(asked->second);
    ConnectionHooks hooks{.suspend = [connection] { MHD_suspend_connection(connection); },
                          .resume = [connection] { MHD_resume_connection(connection); },
                          .hang_up = [fd = descriptor_of(connection)] { shutdown(fd, SHUT_RDWR); }};
    auto* listener = new Listener{&hub_, hub_.listen(after, std::move(hooks))};  // end_events deletes it
    MHD_Response* response =
        MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, kEventBlock, &read_events, listener, &end_events);
    MHD_add_response_header(response, "Content-Type", std::string(api::kEventStream).c_str());
    MHD_add_response_header(response, "Cache-Control", "no-store");
    const MHD_Result queued = MHD_queue_response(connection, MHD_HTTP_OK, response);
    MHD_destroy_response(response);
    return queued;
  }

  static HttpResponse ending() {
    return problem({.code = ErrorCode::Busy,
                    .device = "http",
                    .tried = "answer the request",
                    .seen = "the daemon is ending",
                    .limit = {}});
  }

  void refuse_all_open() {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (const Open& one : open_) one.exchange->answer(ending());
    open_.clear();
  }

  void keep_house() {
    constexpr auto kLook = std::chrono::milliseconds(100);
    Instant last_keep_alive = clock_.now();
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, kLook, [this] { return housekeeping_ends_; })) {
      const Instant now = clock_.now();
      drop_answered_and_late(now);
      if (now - last_keep_alive < options_.keep_alive) continue;
      last_keep_alive = now;
      hub_.keep_alive();
    }
  }

  void drop_answered_and_late(Instant now) {
    open_.remove_if([now](const Open& one) {
      if (!one.exchange->is_answered() && now < one.deadline) return false;
      one.exchange->answer(problem({.code = ErrorCode::TimedOut,
                                    .device = "daemon",
                                    .tried = "answer the request",
                                    .seen = "no answer from the instrument's threads",
                                    .limit = {}}));
      return true;
    });
  }

  void stop_housekeeping() {
    {
      const std::lock_guard lock(mutex_);
      housekeeping_ends_ = true;
    }
    wake_.notify_one();
    if (housekeeper_.joinable()) housekeeper_.join();
  }

  const ServerOptions options_;
  const Clock& clock_;
  const std::uint16_t port_;
  const std::string socket_file_;
  EventHub hub_;
  Gateway gateway_;
  std::vector<MHD_Daemon*> daemons_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::list<Open> open_;
  bool stopping_ = false;
  bool housekeeping_ends_ = false;
  std::thread housekeeper_;
};

}  // namespace

Result<std::unique_ptr<Server>> Server::start(Listeners listeners, const ServerOptions& options, Service& service,
                                              const Clock& clock) {
  auto server = std::make_unique<MicroHttpServer>(options, service, clock, listeners.tcp.port(), listeners.file_path);
  if (listeners.file) GONIO_TRY(server->serve(std::move(*listeners.file)));
  GONIO_TRY(server->serve(std::move(listeners.tcp)));
  server->start_housekeeping();
  return server;
}

}  // namespace gonio::daemon
