#pragma once

#include <string>

namespace gonio::reflectance {

/// A reflectance made of a scan, with all that its uncertainty is made of: standard uncertainties, k = 1.
struct ScanQuantity {
  std::string name;  ///< as in light/quantity_name.h: "rho_dh"
  std::string unit;  ///< "1" or "sr^-1"
  double value = 0.0;
  double u = 0.0;                ///< of all parts
  double u_random = 0.0;         ///< of the readings, each with its own error: adds in quadrature
  double u_shared = 0.0;         ///< of the errors that readings share: each added over the readings first
  double u_interpolation = 0.0;  ///< between the readings: what the next best way to interpolate would have said
  double u_modelled = 0.0;  ///< of what stands where nothing was measured: the choice of it, and how it fits elsewhere
  double u_quadrature = 0.0;
  double k = 2.0;         ///< coverage factor for 95.45 %
  double expanded = 0.0;  ///< U = k u
  /// The part of the value that was not measured but modelled: beyond the arm's reach, in the detector's shadow.
  double modelled_share = 0.0;
};

}  // namespace gonio::reflectance
