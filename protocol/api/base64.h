#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace gonio::api {

/// Bytes as text that JSON can hold: RFC 4648, section 4, with padding, on one line.
[[nodiscard]] std::string to_base64(std::string_view bytes);
/// Errors: InvalidInput for a length that is no multiple of four, or a character that does not belong there.
[[nodiscard]] Result<std::string> from_base64(std::string_view text);

}  // namespace gonio::api
