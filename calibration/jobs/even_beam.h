#pragma once

#include <span>
#include <vector>

#include "base/result.h"
#include "base/units.h"

namespace gonio::calibration {

/// One place of the detector about the direct beam.
struct BeamPlace {
  double x = 0.0;  ///< rad off straight through, at the stage's centre: in the plane of incidence
  double y = 0.0;  ///< likewise across
  double q = 0.0;
  double u = 0.0;  ///< of q, k = 1, each place its own
};

/// The round stop before the detector, by instrument.toml. Uncertainties k = 1.
struct RoundStop {
  Measured<Length> radius;
  Measured<Length> distance;  ///< from the stage's centre
};

/// An even round beam, as it meets the stop.
struct EvenBeam {
  Measured<Length> radius;  ///< u: noise, pointing, stop and distance; as the model has it, whatever chi-square says
  double chi2 = 0.0;        ///< of the places, and of stop and distance against what is stated
  double degrees_of_freedom = 0.0;
  std::vector<double> dradius_dq;  ///< m, of each place: what errors in common do
};

/// Weighted least squares for the level, both coordinates of the centre, the beam's radius b, and a floor that all
/// places have in common (stray light, what the dark's level is off by): the beam passes the stop (radius a, distance
/// D) by what two discs with centres D tan(off) apart have in common,
///   q = floor + level A(D tan(off); a, b) / (pi b^2).
/// a and D are fitted along with what is stated as prior knowledge, so that their u is in b's. `u_pointing`, k = 1,
/// each place its own, tells through the slope. `half_width`: about that of the crossings at half level, to begin with.
/// Errors: IncompleteData (it does not settle, or the places leave something open).
[[nodiscard]] Result<EvenBeam> fit_even_beam(std::span<const BeamPlace> places, const RoundStop& stop, Angle u_pointing,
                                             Angle half_width);

}  // namespace gonio::calibration
