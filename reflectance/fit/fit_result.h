#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "base/units.h"
#include "reflectance/fit/fit_model.h"
#include "reflectance/surface/surface.h"

namespace gonio::fit {

/// What became of one number of the model.
struct FittedParameter {
  std::string name;
  double value = 0.0;
  double u = 0.0;  ///< k = 1; 0 when fixed
  double U = 0.0;  ///< 2 u
  double least = 0.0;
  double most = 1.0;
  bool is_fixed = false;
  bool is_at_bound = false;         ///< the fit would go on: u says little then
  bool is_determined = true;        ///< else the data know it no better than its bounds do
  std::vector<double> per_reading;  ///< d number / d value of each point of the scan [per sr^-1]; empty when fixed
};

/// One reading beside the fitted surface.
struct FitResidual {
  std::size_t point = 0;  ///< index of MeasuredScan::points
  Geometry geometry;
  Brdf fitted;
  Brdf difference;  ///< reading - fitted
  double z = 0.0;   ///< what the shared errors leave of it, by u_random
};

/// What a shared error would have to be for the fit to hold, in its own standard deviations: beyond 3 or so something
/// is not as stated.
struct SharedShift {
  std::string component;
  double standard_deviations = 0.0;
};

/// A model fitted to a scan.
struct FitResult {
  FitModel model;
  std::string scan;
  std::size_t points = 0;
  std::vector<FittedParameter> parameters;  ///< all of the model's, in its order
  std::vector<std::string> free_names;      ///< the order of `correlation`
  std::vector<double> correlation;          ///< row by row
  double chi2 = 0.0;                        ///< with the full covariance; with even weights the sum of squares
  std::size_t degrees_of_freedom = 0;       ///< 0 where there are no more points than free numbers
  std::optional<double> p_value;  ///< the probability of a larger chi2 if model and uncertainties are true; none with
                                  ///< even weights or without degrees of freedom
  double aicc = 0.0;              ///< Akaike's criterion, corrected for few points (Hurvich and Tsai 1989)
  double rms_difference = 0.0;    ///< [sr^-1]
  bool has_even_weights = false;
  bool has_converged = false;
  int starts = 0;
  int agreeing_starts = 0;  ///< that led to the same minimum, the best one
  std::vector<FitResidual> residuals;
  std::vector<SharedShift> shifts;  ///< by size, largest first
  reflectance::Surface surface;

  [[nodiscard]] const FittedParameter* find(std::string_view name) const;
  /// Whether chance explains chi2: a p of 0.001 or more. Without a p nothing tells.
  [[nodiscard]] bool fits() const;
  /// Names of what the data do not determine; empty when all is well.
  [[nodiscard]] std::vector<std::string> undetermined() const;
};

}  // namespace gonio::fit
