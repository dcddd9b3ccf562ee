#include "reflectance/formats/scan_of_file.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace gonio::formats {

using reflectance::MeasuredPoint;
using reflectance::MeasuredScan;

Result<MeasuredScan> scan_of(const MeasuredBrdf& brdf, std::size_t channel, std::uint32_t left_out) {
  GONIO_TRY(check(brdf, brdf.metadata.sample));
  if (channel >= brdf.channels.size()) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = fmt::format("take channel {} of {}", channel, brdf.metadata.sample),
                    .seen = fmt::format("{} channels", brdf.channels.size()),
                    .limit = fmt::format("below {}", brdf.channels.size())});
  }
  MeasuredScan scan{.name = brdf.metadata.sample, .symmetry = symmetry_of(brdf)};
  std::string source;
  for (const std::string& reference : brdf.metadata.references) source += reference + "; ";
  scan.components.push_back({.name = "what all points of the file share", .source = std::move(source)});
  for (const BrdfPoint& point : brdf.points) {
    const double u = standard_u_per_sr(point);
    const double shared = std::min(u, point.u_shared_per_sr);
    MeasuredPoint& p = scan.points.emplace_back();
    p.geometry = geometry_of(point);
    p.value = per_steradian(point.f_per_sr);
    p.u_random = per_steradian(std::sqrt((u - shared) * (u + shared)));
    if (shared > 0.0) p.shared.push_back({.component = 0, .per_sd = per_steradian(shared)});
    p.is_flagged = point.channel != channel || (point.flags & left_out) != 0;
  }
  return scan;
}

}  // namespace gonio::formats
