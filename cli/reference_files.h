#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "protocol/api/requests.h"

namespace gonio::cli {

/// What the daemon says of a table that it does not take.
inline constexpr std::string_view kContradiction = "contradicts itself";

/// A reference as it is sent: the texts of the files. `shape_file` and `shape_of` may be empty. The daemon says what is
/// wrong with them. Errors: FileUnreadable.
[[nodiscard]] Result<api::ReferenceImport> read_reference(const std::string& file, const std::string& shape_file,
                                                          const std::string& shape_of, bool replace);

/// A text as the value of a query (RFC 3986: all but unreserved characters as %XX).
[[nodiscard]] std::string query_text(std::string_view text);

}  // namespace gonio::cli
