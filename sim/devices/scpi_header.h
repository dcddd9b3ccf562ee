#pragma once

#include <string_view>

namespace gonio::sim {

/// Whether a header is the one of the pattern: nodes in short or long form, in any case, optional nodes left out or not
/// (SCPI-99, volume 1, 6.2). A pattern has the short form in capitals, optional nodes in brackets, and its '?':
/// "SENSe:POWer:[DC]:RANGe:[UPPer]?". A leading colon of the header is passed over.
[[nodiscard]] bool is_header(std::string_view pattern, std::string_view header);

}  // namespace gonio::sim
