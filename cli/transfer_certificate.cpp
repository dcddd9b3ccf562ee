#include "cli/transfer_certificate.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

namespace gonio::cli {
namespace {

Error no_certificate(const api::CalibrationReport& transfer, std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .device = "calibration",
          .tried = fmt::format("write the certificate of calibration {}", transfer.version),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

// "reff_0_45_568nm": 568.
std::optional<std::string> wavelength_of(std::string_view name) {
  constexpr std::string_view kBegin = "reff_0_45_";
  constexpr std::string_view kEnd = "nm";
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) return std::nullopt;
  name.remove_prefix(kBegin.size());
  name.remove_suffix(kEnd.size());
  return std::string(name);
}

// One number for all pairs, as a certificate's file has it.
double mean_correlation(const api::CalibrationReport& transfer) {
  const std::size_t n = transfer.values.size();
  if (n < 2 || transfer.covariance.size() != n * n) return 1.0;
  double sum = 0.0;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      const double scale = transfer.values[a].u * transfer.values[b].u;
      sum += scale > 0.0 ? transfer.covariance[a * n + b] / scale : 0.0;
    }
  }
  return std::clamp(2.0 * sum / static_cast<double>(n * (n - 1)), 0.0, 1.0);
}

std::string one_line_of(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

}  // namespace

Result<std::string> certificate_csv(const api::CalibrationReport& transfer, const std::string& expires,
                                    double longest_gap_nm) {
  constexpr double kCoverage = 2.0;
  constexpr std::size_t kDay = 10;  // of "2026-11-22T18:05:00Z"
  if (transfer.job != "transfer") {
    return failure(no_certificate(transfer, "it is of the job " + transfer.job, "a version of the job transfer"));
  }
  std::string text =
      fmt::format("# serial: {}\n# material: working standard, {}, scan {}, calibration {}\n",
                  one_line_of(transfer.sample), one_line_of(transfer.note), transfer.scan, transfer.version);
  text += fmt::format("# date: {}\n# expires: {}\n# geometry: 0/45\n# coverage_factor: {:g}\n",
                      transfer.utc.substr(0, kDay), expires, kCoverage);
  text += fmt::format("# uncertainty_kind: absolute\n# correlation: {:.4f}\n", mean_correlation(transfer));
  if (transfer.values.size() > 1) text += fmt::format("# longest_gap_nm: {:g}\n", longest_gap_nm);
  text += "wavelength_nm,reflectance,uncertainty\n";
  std::size_t rows = 0;
  for (const api::FoundValueReport& found : transfer.values) {
    const auto nm = wavelength_of(found.name);
    if (!nm) continue;
    text += fmt::format("{},{:.6f},{:.6f}\n", *nm, found.value, kCoverage * found.u);
    ++rows;
  }
  if (rows > 0) return text;
  return failure(no_certificate(transfer, "it found no reflectance factor at 0/45", "one at least"));
}

}  // namespace gonio::cli
