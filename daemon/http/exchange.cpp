#include "daemon/http/exchange.h"

#include "protocol/api/json.h"

namespace gonio::daemon {

HttpResponse problem(const Error& error, int status) {
  return {.status = status == 0 ? traits(error.code).http_status : status,
          .content_type = std::string(api::kProblemJson),
          .body = api::to_problem_json(error, status)};
}

void Exchange::answer(HttpResponse response) {
  const std::lock_guard lock(mutex_);
  if (response_) return;
  response_ = std::move(response);
  wake_();
}

bool Exchange::is_answered() const {
  const std::lock_guard lock(mutex_);
  return response_.has_value();
}

}  // namespace gonio::daemon
