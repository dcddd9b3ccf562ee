#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "base/units.h"
#include "calibration/instrument_model.h"
#include "calibration/term_list.h"

namespace gonio::calibration {

/// What a wrong wavelength does to one value.
struct SpectralSlope {
  double per_metre = 0.0;         ///< d f_s/d lambda - f_s d ln f_ref/d lambda, sr^-1 per m
  double per_square_metre = 0.0;  ///< second derivative likewise; 0 with fewer than three wavelengths
};

/// A value where it was measured, for its neighbours in wavelength.
struct SpectralPoint {
  Geometry planned;
  Wavelength wavelength;
  double over_certificate = 0.0;  ///< f_s / rho_cert: what a shift of both readings' wavelength leaves
  double certificate = 0.0;
};

/// Divided differences over the nearest one or two wavelengths at the same planned geometry (to 0.001 deg); zeros where
/// a geometry has one wavelength only: nothing is known then, and nothing said. [points], in their order.
[[nodiscard]] std::vector<SpectralSlope> spectral_slopes(std::span<const SpectralPoint> points);

/// The centroid's error is shared by all points of one wavelength; an even passband of full width w shifts f by w^2 /
/// 24 f'' (Taylor; a rectangle's variance is w^2 / 12), uncorrected, shared likewise. Nothing without a stated model.
void add_spectral_terms(const SpectralSlope& slope, Wavelength wavelength, const InstrumentModel& instrument,
                        TermList& terms);

}  // namespace gonio::calibration
