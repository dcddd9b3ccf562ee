#pragma once

#include <string>
#include <vector>

#include "daemon/analysis/picture.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::analysis {

/// What the pictures of one channel are made of: its points, and the surface between them.
struct ChannelView {
  std::string stem;   ///< of the files, for the tables' names
  std::string tail;   ///< "", or "-550nm" where there are several channels
  std::string title;  ///< "wheat, 568 nm"
  std::vector<formats::BrdfPoint> points;
  const reflectance::Surface* surface = nullptr;  ///< may be absent: points alone make none
};

/// Incidences of the points, nominal: those within 0.5 deg are one. At most `most`, spread over all.
struct IncidenceGroup {
  double theta_i_deg = 0.0;
  double phi_i_deg = 0.0;
  std::vector<formats::BrdfPoint> points;
};
[[nodiscard]] std::vector<IncidenceGroup> incidence_groups(const std::vector<formats::BrdfPoint>& points,
                                                           std::size_t most);

/// f_r over the hemisphere as a body whose radius it is: one panel an incidence.
[[nodiscard]] Picture lobe_picture(const ChannelView& view);
/// The hemisphere seen along the normal, colour for f_r; where nothing was measured it stays white.
[[nodiscard]] Picture polar_picture(const ChannelView& view);
/// The plane of incidence: readings with U, and the surface between them.
[[nodiscard]] Picture cut_picture(const ChannelView& view);

}  // namespace gonio::analysis
