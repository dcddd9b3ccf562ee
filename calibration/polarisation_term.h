#pragma once

#include "calibration/instrument_model.h"
#include "calibration/point_equation.h"
#include "calibration/term_list.h"

namespace gonio::calibration {

/// (R_s - R_p) / (R_s + R_p) of a clear mirror facet of this index at half the phase angle (Fresnel; Born and Wolf
/// 1999, 1.5.3): what a surface of facets polarises by.
[[nodiscard]] double facet_diattenuation(const Geometry& g, double refractive_index);

/// The residual of one state of light. With the lamp's degree P, the detector's diattenuation D and a surface of
/// diattenuation C along their planes, that keeps the part R <= 1 of what is polarised, the reading is (Mueller
/// calculus, both planes along s or p: the worst case)
///   f (1 + P C + D C + P D R);
/// C is unknown with the standard uncertainty u_sample (times a facet's where one is stated), R no larger than C's
/// bound, so that u = f ((P + D) C + P D) u_sample, and the reference's likewise with u_reference and C = 1. A point
/// measured in s or p light has P = 1, with opposite signs: the mean of both is free of it, and of D C no more than
/// before. One shared component for the sample and one for the reference.
void add_polarisation_terms(const PairedPoint& point, const InstrumentModel& instrument, TermList& terms);

}  // namespace gonio::calibration
