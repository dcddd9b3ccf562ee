#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "protocol/api/analysis.h"
#include "protocol/api/calibration_reports.h"
#include "protocol/api/instrument_report.h"
#include "protocol/api/reports.h"
#include "protocol/api/requests.h"
#include "protocol/api/scan_review.h"

namespace gonio::api {

/// The JSON of any report or request of this room: an object with the names of its members.
template <class T>
[[nodiscard]] std::string to_json(const T& message);

/// A report as a client reads it: members that are not there keep their default, others than known are passed over, so
/// that a newer daemon may say more. Errors: BadReply.
template <class T>
[[nodiscard]] Result<T> report_from_json(std::string_view text);

/// A request as the daemon reads it, strictly. An empty text is `{}`. Errors: InvalidInput, UnknownKey, with the
/// member.
template <class T>
[[nodiscard]] Result<T> request_from_json(std::string_view text);

/// RFC 9457: the error as application/problem+json, with all its members, and back. `http_status` 0: the one of the
/// code.
[[nodiscard]] std::string to_problem_json(const Error& error, int http_status = 0);
/// What an answer of another origin says (no problem+json) becomes BadReply with its status and first words.
[[nodiscard]] Error error_from_problem(int http_status, std::string_view body);

}  // namespace gonio::api
