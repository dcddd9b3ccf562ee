#pragma once

#include <string>
#include <string_view>

#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// Whether these bytes are UTF-8 (RFC 3629: shortest forms only, no surrogates).
[[nodiscard]] bool is_utf8(std::string_view text);

/// The text as it is if it is UTF-8; else each byte as the character of ISO 8859-1 that it is in older files ("µm").
[[nodiscard]] std::string as_utf8(std::string_view text);

/// The same for every name and text of the metadata, channels and flags: JSON holds nothing else.
void make_texts_utf8(MeasuredBrdf& brdf);

}  // namespace gonio::formats
