#pragma once

#include "base/geometry.h"
#include "calibration/instrument_model.h"
#include "calibration/point_equation.h"
#include "calibration/term_list.h"

namespace gonio::calibration {

/// What a leaning, raised surface makes of the arms' directions.
struct SurfaceView {
  Geometry geometry;        ///< in the frame of the surface, seen from where the detector's axis meets it
  double irradiance = 1.0;  ///< (nominal distance of the source / true one)^2
};

/// The directions as the surface on this mount has them. The normal is (sin l cos a, sin l sin a, cos l) with l cos a =
/// lean_0, l sin a = lean_90; phi is carried along without a twist (Rodrigues 1840). Both arms aim at their common
/// centre; the detector's axis meets the surface at p = (n . h z) / (n . r) r, and the light comes to p from the
/// source's place at its distance D: a height h shifts theta_i by up to h tan(theta_r) cos(theta_i) / D and the
/// irradiance by 2 h / D. Threads: any.
[[nodiscard]] SurfaceView view_on(const MountModel& mount, Length source_distance, const Geometry& arms);

/// Terms of the lean and height of the sample and of the reference: what one standard deviation of each, put into
/// view_on, does to the reading through the cosine of theta_i, the source's distance and the BRDF's own slopes; and
/// what those slopes leave unresolved. Nothing without a stated mounting.
void add_mounting_terms(const PairedPoint& point, const DirectionSlopes& slopes, const InstrumentModel& instrument,
                        TermList& terms);

}  // namespace gonio::calibration
