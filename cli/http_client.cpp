#include "cli/http_client.h"

#include <curl/curl.h>

namespace gonio::cli {
namespace {

constexpr std::string_view kUnix = "unix:";
constexpr long kConnectSeconds = 5;

struct CurlDeleter {
  void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};
using Handle = std::unique_ptr<CURL, CurlDeleter>;
using Headers = std::unique_ptr<curl_slist, CurlDeleter>;

struct Sink {
  const std::function<bool(std::string_view)>* take = nullptr;  ///< of a successful stream; else all goes to `body`
  CURL* handle = nullptr;
  std::string body;
  bool ended_by_us = false;
};

std::size_t on_bytes(char* data, std::size_t, std::size_t size, void* user) {
  auto* sink = static_cast<Sink*>(user);
  long status = 0;
  curl_easy_getinfo(sink->handle, CURLINFO_RESPONSE_CODE, &status);
  if (sink->take == nullptr || status != 200) {
    sink->body.append(data, size);
    return size;
  }
  if ((*sink->take)({data, size})) return size;
  sink->ended_by_us = true;
  return 0;
}

int on_progress(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<const std::atomic<bool>*>(user)->load() ? 1 : 0;
}

Headers header_list(const std::map<std::string, std::string>& headers) {
  curl_slist* list = nullptr;
  for (const auto& [name, value] : headers) list = curl_slist_append(list, (name + ": " + value).c_str());
  list = curl_slist_append(list, "Expect:");  // no round trip before the body
  return Headers(list);
}

}  // namespace

struct HttpClient::Impl {
  Handle handle;
  std::string base;
  std::string socket_file;
  std::string shown;
  const std::atomic<bool>* interrupted = nullptr;

  void prepare(const std::string& path, const Headers& headers, Sink& sink, std::chrono::seconds patience) {
    CURL* h = handle.get();
    sink.handle = h;
    curl_easy_reset(h);
    curl_easy_setopt(h, CURLOPT_URL, (base + path).c_str());
    if (!socket_file.empty()) curl_easy_setopt(h, CURLOPT_UNIX_SOCKET_PATH, socket_file.c_str());
    curl_easy_setopt(h, CURLOPT_PROXY, "");  // the daemon is on this machine, whatever the environment says
    curl_easy_setopt(h, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(h, CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
    curl_easy_setopt(h, CURLOPT_TIMEOUT, static_cast<long>(patience.count()));
    curl_easy_setopt(h, CURLOPT_HTTPHEADER, headers.get());
    curl_easy_setopt(h, CURLOPT_WRITEFUNCTION, &on_bytes);
    curl_easy_setopt(h, CURLOPT_WRITEDATA, &sink);
    curl_easy_setopt(h, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(h, CURLOPT_XFERINFOFUNCTION, &on_progress);
    curl_easy_setopt(h, CURLOPT_XFERINFODATA, const_cast<std::atomic<bool>*>(interrupted));
  }

  Result<HttpReply> perform(Sink& sink) {
    const CURLcode code = curl_easy_perform(handle.get());
    long status = 0;
    curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &status);
    if (code == CURLE_OK || sink.ended_by_us) return HttpReply{static_cast<int>(status), std::move(sink.body)};
    Error error{
        .code = ErrorCode::NoDaemon, .device = shown, .tried = "ask the daemon", .seen = curl_easy_strerror(code)};
    if (code == CURLE_OPERATION_TIMEDOUT && status == 0) {
      double connected = 0.0;
      curl_easy_getinfo(handle.get(), CURLINFO_CONNECT_TIME, &connected);
      if (connected > 0.0) error.code = ErrorCode::TimedOut;
    }
    if (code == CURLE_ABORTED_BY_CALLBACK) {
      error.code = ErrorCode::Stopped;
      error.seen = "interrupted";
    }
    return failure(std::move(error));
  }
};

HttpClient::HttpClient(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HttpClient::HttpClient(HttpClient&&) noexcept = default;
HttpClient& HttpClient::operator=(HttpClient&&) noexcept = default;
HttpClient::~HttpClient() = default;

Result<HttpClient> HttpClient::open(const std::string& connect, const std::atomic<bool>& interrupted) {
  auto impl = std::make_unique<Impl>();
  impl->shown = connect;
  impl->interrupted = &interrupted;
  if (connect.starts_with(kUnix)) {
    impl->socket_file = connect.substr(kUnix.size());
    impl->base = "http://localhost";
  } else if (connect.starts_with("http://")) {
    impl->base = connect.ends_with('/') ? connect.substr(0, connect.size() - 1) : connect;
  } else {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "find the daemon",
                    .seen = "\"" + connect + "\"",
                    .limit = "http://ADDRESS:PORT or unix:PATH",
                    .where = InputLocation{"", 0, "--connect"}});
  }
  impl->handle.reset(curl_easy_init());
  return HttpClient(std::move(impl));
}

Result<HttpReply> HttpClient::get(const std::string& path, std::chrono::seconds patience) {
  Sink sink;
  const Headers headers = header_list({});
  impl_->prepare(path, headers, sink, patience);
  return impl_->perform(sink);
}

Result<HttpReply> HttpClient::post(const std::string& path, const std::string& json_body,
                                   const std::map<std::string, std::string>& headers, std::chrono::seconds patience) {
  Sink sink;
  std::map<std::string, std::string> all = headers;
  all["Content-Type"] = "application/json";
  const Headers list = header_list(all);
  impl_->prepare(path, list, sink, patience);
  curl_easy_setopt(impl_->handle.get(), CURLOPT_POSTFIELDS, json_body.c_str());
  curl_easy_setopt(impl_->handle.get(), CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(json_body.size()));
  return impl_->perform(sink);
}

Result<HttpReply> HttpClient::stream(const std::string& path, const std::map<std::string, std::string>& headers,
                                     const std::function<bool(std::string_view)>& take) {
  Sink sink{.take = &take};
  const Headers list = header_list(headers);
  impl_->prepare(path, list, sink, std::chrono::seconds(0));
  Result<HttpReply> reply = impl_->perform(sink);
  if (!reply || sink.ended_by_us || reply->status != 200) return reply;
  return failure({.code = ErrorCode::NoDaemon,
                  .device = impl_->shown,
                  .tried = "listen to events",
                  .seen = "the stream has ended"});
}

}  // namespace gonio::cli
