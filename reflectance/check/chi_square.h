#pragma once

namespace gonio::reflectance {

/// The probability that chi-square with `degrees_of_freedom` > 0 exceeds `chi2` >= 0 (both asserted): Q(dof/2, chi2/2),
/// the regularised upper incomplete gamma function, by series or continued fraction (Abramowitz and Stegun 6.5.29,
/// 6.5.31). To some 1e-14 relative, down to 1e-300 and for up to 1e6 degrees of freedom.
[[nodiscard]] double chi_square_probability(double chi2, double degrees_of_freedom);

}  // namespace gonio::reflectance
