#pragma once

#include <string>
#include <vector>

#include "base/geometry.h"
#include "daemon/analysis/picture.h"

namespace gonio::analysis {

/// How far one reading is from what it is compared with.
struct Deviation {
  Geometry geometry;
  double value = 0.0;  ///< in u of what does not cancel, or in sr^-1
};

struct DeviationsView {
  std::string stem;     ///< of the files, for the tables' names
  std::string name;     ///< of the picture: "residuals"
  std::string title;    ///< "What the fit of rpv leaves"
  std::string caption;  ///< a sentence
  std::string label;    ///< of the axis: "(reading - fit) / u"
  bool is_in_u = true;  ///< then -2 and 2 are marked, and colours go from -4 to 4
  std::vector<Deviation> points;
};

/// Deviations by phase angle, and their map over the directions of view: source at the right, retro-reflection and the
/// mirror direction of each incidence marked where there are at most six.
[[nodiscard]] Picture deviations_picture(const DeviationsView& view);

}  // namespace gonio::analysis
