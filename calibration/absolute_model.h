#pragma once

#include <limits>
#include <vector>

#include "base/units.h"

namespace gonio::calibration {

/// A reading of the direct beam: straight through, nothing on the stage, the attenuator in the way, all of the beam on
/// the detector. What the job of that name measures.
struct DirectBeam {
  Wavelength wavelength;
  Measured<double> q;  ///< as NormalisedReading: per unit of the monitor; u its own noise and the darks', k = 1
  double degrees_of_freedom = std::numeric_limits<double>::infinity();  ///< of that u
  double mean_net_dn = 0.0;                ///< as NormalisedReading: what linearity depends on
  double dlnq_dt0 = 0.0;                   ///< 1/s
  Measured<double> attenuation{1.0, 0.0};  ///< by what stood in its way when it was read: light passed / light
};

/// What a measurement without a standard rests on. Uncertainties k = 1.
struct AbsoluteModel {
  std::vector<DirectBeam> beams;       ///< one a wavelength
  Measured<Length> aperture_radius;    ///< of the round stop that bounds what the detector takes in
  Measured<Length> aperture_distance;  ///< from the arms' centre
};

}  // namespace gonio::calibration
