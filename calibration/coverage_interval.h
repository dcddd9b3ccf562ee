#pragma once

#include <span>

namespace gonio::calibration {

/// k for a level of confidence of 95.45 % of the sum of a normal and a rectangular error, `ratio` = u of the
/// rectangular one over u of the normal one (>= 0; infinity: 0.9545 sqrt(3) = 1.653; 0: 2). From the distribution
/// itself:
///   P(|N + R| <= x) = 2 F(x) - 1,  F(x) = (s / 2a) (Psi((x + a) / s) - Psi((x - a) / s)),  Psi(z) = z Phi(z) + phi(z),
/// the integral of Phi over the rectangle of half width a = sqrt(3) u_R, s = u_N (JCGM 101:2008, 6.4.2).
[[nodiscard]] double coverage_factor_with_rectangle(double ratio);

/// The same of one normal error, one rectangular and any number of arcsine ones, by their standard uncertainties (>= 0,
/// one above 0). By the product of their characteristic functions (JCGM 101:2008, 6.4.2 and 6.4.6),
///   g(t) = exp(-(s t)^2 / 2) sin(a t) / (a t) prod J0(b t),  a = sqrt(3) u_R, b = sqrt(2) u_A,
///   P(|X| <= x) = x / L + sum_n 2 / (n pi) g(n pi / L) sin(n pi x / L),
/// the cosine series of the density on +-L (Fang and Oosterlee 2008, eq 11) integrated, L = 5 u. The normal part counts
/// as 2 % of u at least, so that the series ends; that makes k larger by at most 0.5 %. With no arcsine, the function
/// above.
[[nodiscard]] double coverage_factor_with_bounds(double u_normal, double u_rectangle,
                                                 std::span<const double> u_arcsines);

}  // namespace gonio::calibration
