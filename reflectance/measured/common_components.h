#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "reflectance/check/group_chi_square.h"
#include "reflectance/measured/measured_scan.h"

namespace gonio::reflectance {

/// Numbers the components of several scans, those of one source alike.
class CommonComponents {
 public:
  /// The numbers of the scan's components, in their order.
  [[nodiscard]] std::vector<std::uint32_t> add(const MeasuredScan& scan);

 private:
  std::map<std::string, std::uint32_t> by_source_;
  std::uint32_t next_ = 0;
};

/// A point with its components renumbered.
[[nodiscard]] GroupMember group_member(const MeasuredPoint& point, const std::vector<std::uint32_t>& numbers);

/// Errors: InvalidInput, naming scan and point, for a usable point whose u_random is 0: it would outweigh all others.
[[nodiscard]] Result<void> check_random_parts(const MeasuredScan& scan);

/// Errors: InvalidInput for a tolerance outside of 0 to 5 deg.
[[nodiscard]] Result<void> check_tolerance(Angle tolerance);

}  // namespace gonio::reflectance
