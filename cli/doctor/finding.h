#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace gonio::cli {

/// Warning: it works, and will not for long, or not as well as it could. Skipped: it could not be tried.
enum class Verdict : std::uint8_t { Ok, Warning, Failed, Skipped };
[[nodiscard]] std::string_view verdict_name(Verdict verdict);

/// What came of one check.
struct Finding {
  std::string check;  ///< "stage answers", "axis theta_i moves"
  Verdict verdict = Verdict::Ok;
  std::string seen;    ///< with its unit
  std::string limit;   ///< what it was held against; may be empty
  std::string remedy;  ///< what to do; empty when all is well
};

}  // namespace gonio::cli
