#pragma once

namespace gonio::calibration {

/// k for a level of confidence of 95.45 % of the sum of a normal and a rectangular error, `ratio` = u of the
/// rectangular one over u of the normal one (>= 0; infinity: 0.9545 sqrt(3) = 1.653; 0: 2). From the distribution
/// itself:
///   P(|N + R| <= x) = 2 F(x) - 1,  F(x) = (s / 2a) (Psi((x + a) / s) - Psi((x - a) / s)),  Psi(z) = z Phi(z) + phi(z),
/// the integral of Phi over the rectangle of half width a = sqrt(3) u_R, s = u_N (JCGM 101:2008, 6.4.2).
[[nodiscard]] double coverage_factor_with_rectangle(double ratio);

}  // namespace gonio::calibration
