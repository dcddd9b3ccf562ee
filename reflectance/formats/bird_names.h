#pragma once

#include <string_view>

// The words that bird_writer.cpp and bird_reader.cpp share.
namespace gonio::formats::bird {

inline constexpr std::string_view kSchema =
    "https://raw.githubusercontent.com/BiRD-project/BiRD_view/master/BRDF_JSON_schema/brdf_json_schema_v1.0.json";
inline constexpr std::string_view kNotStated = "not stated";
inline constexpr std::string_view kNoEmail = "not-stated@example.invalid";  // the schema wants an address (RFC 2606)
inline constexpr std::string_view kNoTime = "1970-01-01T00:00:00Z";
inline constexpr std::string_view kNotApplicable = "NA";
inline constexpr std::string_view kUrn = "urn:gonio-unnamed:";

// adhoc_variables
inline constexpr std::string_view kSigned = "f_signed";
inline constexpr std::string_view kCoverage = "coverage_factor";
inline constexpr std::string_view kShared = "u_shared";
inline constexpr std::string_view kFlags = "flags";
inline constexpr std::string_view kChannel = "channel";

}  // namespace gonio::formats::bird
