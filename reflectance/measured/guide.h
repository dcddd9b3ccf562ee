#pragma once

#include <span>
#include <string>
#include <vector>

#include "reflectance/measured/measured_scan.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// A surface by which readings are divided before they are interpolated, and the values between them multiplied again:
/// where it has the shape of the sample, what is left to interpolate is smooth. Its scale does not matter.
struct Guide {
  std::string name;  ///< "flat", "matte", "lobe", "fitted"
  Surface surface;
};

/// The guides worth trying on a scan, found without a fit: "flat" (the readings as they are), "matte" (the bowl, bell
/// or hot spot that fits best, of 66 shapes of Rahman, Pinty and Verstraete), "lobe" (facets on a diffuse ground, the
/// best of 36). A guide is left out where it is not above 0 at all readings. The scan has passed `check`.
[[nodiscard]] std::vector<Guide> candidate_guides(const MeasuredScan& scan);

}  // namespace gonio::reflectance
