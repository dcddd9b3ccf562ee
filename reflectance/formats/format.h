#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

enum class Format : std::uint8_t { Csv, Bird, Astm, Zemax, Merl, Ssdd, Pab, Alta, Klems, Rgl, Nexus };

/// "csv", "bird", "astm", "zemax", "merl", "ssdd", "pab", "alta", "klems", "rgl", "nexus": what users write.
[[nodiscard]] std::string_view format_name(Format format);
[[nodiscard]] std::optional<Format> format_from_name(std::string_view name);
/// pab text and Klems XML are written only, ALTA text is read only.
[[nodiscard]] bool is_readable(Format format);
[[nodiscard]] bool is_writable(Format format);

/// By what stands in the file, never by its name: two formats call themselves ".bsdf". Absent where it is none of them.
[[nodiscard]] std::optional<Format> detect_format(std::string_view bytes);

/// Reads whatever `detect_format` finds, with or without UTF-8's byte order mark; `sidecar` goes with a CSV. Names and
/// texts that are not UTF-8 are taken for ISO 8859-1. Errors:
/// InvalidInput (none of the formats, with what they are; UTF-16; one that is only written), else as the reader of the
/// format.
[[nodiscard]] Result<MeasuredBrdf> read_brdf(std::string_view bytes, const std::string& file,
                                             std::optional<std::string_view> sidecar = std::nullopt);

}  // namespace gonio::formats
