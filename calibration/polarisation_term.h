#pragma once

#include "calibration/instrument_model.h"
#include "calibration/point_equation.h"
#include "calibration/term_list.h"

namespace gonio::calibration {

/// (R_s - R_p) / (R_s + R_p) of a clear mirror facet of this index at half the phase angle (Fresnel; Born and Wolf
/// 1999, 1.5.3): what a surface of facets polarises by.
[[nodiscard]] double facet_diattenuation(const Geometry& g, double refractive_index);

/// The plane of a facet as an arm sees it, against the arm's own horizontal direction across its axis: cos and sin of
/// twice the angle between the two.
struct PlaneTurn {
  double cosine = 1.0;
  double sine = 0.0;
};
/// At the arm of `own_theta`; `dphi` from its azimuth to that of the other direction. s is across both directions, so
/// with the other one's parts a along growing theta and b along growing phi it is (a^2 - b^2, 2 a b) / (a^2 + b^2).
/// Light straight back has no plane: no turn.
[[nodiscard]] PlaneTurn facet_turn(Angle own_theta, Angle other_theta, Angle dphi);

/// The residual of one state of light. With the lamp's degree P, the detector's diattenuation D, their planes at psi_P
/// and psi_D from the s direction, and a surface of diattenuation C that keeps the part R <= 1 of what is polarised,
/// the reading is (Mueller calculus; Chipman, Lam and Young 2018, ch. 6)
///   f (1 + P C cos 2 psi_P + D C cos 2 psi_D + P D R cos 2 (psi_P -+ psi_D)).
/// The three cosines are three independent errors where nobody knows the planes; u_sample is the standard uncertainty
/// of C cos 2 psi (times a facet's C where an index is stated), u_reference the standard's. A point measured in s or p
/// light has P = 1, with opposite signs: the mean of both is free of the source's part and of the product. Shared. Of
/// clear facets the plane of each point is known (facet_turn) and psi = psi_0 - eta turns with it,
///   cos 2 psi = cos 2 eta cos 2 psi_0 + sin 2 eta sin 2 psi_0,
/// psi_0 the arm's own plane: two errors with known signs, so that points of other planes do not err as one; of any
/// plane at all (kOfAnyPlane) both together are one arcsine error, of a point and of a sum. Where the surface is not
/// stated to be of facets, only the size is known.
void add_polarisation_terms(const PairedPoint& point, const InstrumentModel& instrument, TermList& terms);

}  // namespace gonio::calibration
