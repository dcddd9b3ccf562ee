#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "reflectance/formats/brdf_metadata.h"
#include "reflectance/formats/brdf_point.h"
#include "reflectance/formats/channel.h"

namespace gonio::formats {

/// A measured BRDF as every format is read into and written from: points in any order, on a grid or not.
struct MeasuredBrdf {
  BrdfMetadata metadata;
  std::vector<Channel> channels;
  std::vector<std::string> flag_names;  ///< at most 32
  std::vector<BrdfPoint> points;
  friend bool operator==(const MeasuredBrdf&, const MeasuredBrdf&) = default;
};

/// No file holds more points than this: some 1.3 GB of them.
inline constexpr std::size_t kMostPoints = 16'000'000;

/// What every reader ends with and every writer begins with. Errors: InvalidInput, naming `file` and the point's index
/// (from 0) and field: no points, more than kMostPoints, a number that is not finite, a theta outside of [-90, 90] deg,
/// a negative uncertainty, a channel or flag that is not in the lists.
[[nodiscard]] Result<void> check(const MeasuredBrdf& brdf, const std::string& file);

/// The declared symmetry, else the least that the points' azimuths need: anisotropic when phi_i varies, isotropic when
/// all views lie on one side of the plane of incidence.
[[nodiscard]] reflectance::TableSymmetry symmetry_of(const MeasuredBrdf& brdf);

}  // namespace gonio::formats
