#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace gonio::reflectance {

/// ln H(mu) of isotropic scatterers, exactly: H(mu) = 1 + (omega0/2) mu H(mu) integral of H(u)/(mu + u) du over [0, 1]
/// (Chandrasekhar 1950), from its closed form (Stibbs and Weir 1959)
///   ln H = -(mu/pi) integral of ln(1 - omega0 x cot x) / (cos^2 x + mu^2 sin^2 x) dx over [0, pi/2].
/// The integral is done once for all mu: `log` interpolates, to 2e-15 of H. Copies share the table. Threads: any.
class ChandrasekharH {
 public:
  /// By 1 - omega0 in [0, 1], which holds the digits of an almost loss-free medium (asserted).
  explicit ChandrasekharH(double one_minus_omega0);

  /// ln H; `mu` in [0, 1], taken as at least 2^-40.
  [[nodiscard]] double log(double mu) const {
    int exponent = 0;
    const double fraction = std::frexp(mu, &exponent);  // mu = fraction 2^exponent, fraction in [1/2, 1)
    if (exponent > 0) return value(0, 1.0);             // mu = 1
    return -exponent < kOctaves ? value(-exponent, 4.0 * fraction - 3.0) : value(kOctaves - 1, -1.0);
  }

 private:
  static constexpr int kOctaves = 40;
  // The singularity at mu = 0 lies 3 half-widths from the middle of an octave: 5.8^-20 = 5e-16.
  static constexpr int kDegree = 20;
  using Octave = std::array<double, kDegree + 1>;  // powers of t in [-1, 1]

  // In two interleaved chains, which a processor follows at once.
  [[nodiscard]] double value(int octave, double t) const {
    const Octave& c = (*octaves_)[static_cast<std::size_t>(octave)];
    const double t2 = t * t;
    double even = c[kDegree];
    double odd = c[kDegree - 1];
    for (std::size_t k = kDegree; k >= 4; k -= 2) {
      even = even * t2 + c[k - 2];
      odd = odd * t2 + c[k - 3];
    }
    return even * t2 + odd * t + c[0];
  }

  std::shared_ptr<const std::vector<Octave>> octaves_;
};

}  // namespace gonio::reflectance
