#pragma once

#include <optional>
#include <string>

#include "base/error.h"
#include "cli/doctor/finding.h"

namespace gonio::cli {

/// The body of a move of one axis, by its name.
[[nodiscard]] std::string trial_move_body(const std::string& axis, double to);

/// A move to `end` that was stopped: `ended_by` is how it was answered, `took_s` how long STOP took to be acknowledged.
[[nodiscard]] Finding check_stop(const std::string& axis, double end, double stands, double took_s,
                                 const std::optional<Error>& ended_by);

}  // namespace gonio::cli
