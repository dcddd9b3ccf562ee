#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/reflectance/cases.h"
#include "reflectance/integral/prepared_reflectance.h"

namespace gonio::bench {

enum class Family : std::uint8_t {
  Ours,      ///< rho_dh as the room offers it
  Prepared,  ///< PreparedReflectance, made beforehand
  OurPart,   ///< one of the methods that it chooses from
  Grid,      ///< a fixed set of directions, made beforehand
  Adaptive,  ///< a general library quadrature, asked for a tolerance
};

struct Estimate {
  double value = 0.0;
  std::uint64_t evaluations = 0;
};

/// One setting of a method, ready to be run on one case, many times in one call: a reading of 10 ns would be lost in
/// the cost of the call.
struct Rung {
  std::string setting;
  std::function<Estimate(long repeats)> run;
};

/// `once` as a Rung runs it; the compiler may not take one repeat for another.
template <class F>
[[nodiscard]] std::function<Estimate(long)> repeated(F once) {
  return [once](long repeats) {
    Estimate estimate;
    for (long k = 0; k < repeats; ++k) {
      estimate = once();
      asm volatile("" : : "g"(&estimate) : "memory");
    }
    return estimate;
  };
}

/// A way to rho_dh with its settings from coarse to fine.
struct Method {
  std::string name;
  Family family = Family::Grid;
  std::function<std::vector<Rung>(const Case&)> rungs;
};

/// Each in a source of its own, which alone knows the library behind it.
[[nodiscard]] std::vector<Method> our_methods();
[[nodiscard]] std::vector<Method> grid_methods();
[[nodiscard]] std::vector<Method> cubature_methods();  ///< S. G. Johnson's cubature: hcubature and pcubature
[[nodiscard]] std::vector<Method> gsl_methods();       ///< GSL: QAGS and CQUAD, one inside the other

/// A surface that has been prepared, and how long that took.
struct Prepared {
  reflectance::PreparedReflectance reflectance;
  double seconds = 0.0;
};
[[nodiscard]] const Prepared& prepared(const Case& c, double tolerance);

/// Tolerances from 1e-1 to `finest`, `per_decade` of them in each decade.
[[nodiscard]] std::vector<double> tolerance_ladder(double finest, int per_decade);
[[nodiscard]] std::string tolerance_text(double tolerance);

/// The integrand of the two coordinate systems in which a general quadrature is used, over half of the azimuths: the
/// surfaces compared are symmetric to the plane of incidence, and the general methods are given that knowledge too.
[[nodiscard]] double integrand_in_theta(const Case& c, const reflectance::Direction& i, double theta, double phi);
[[nodiscard]] double integrand_in_mu(const Case& c, const reflectance::Direction& i, double mu, double phi);

/// No general quadrature may take more evaluations than this in one run.
inline constexpr std::uint64_t kMostEvaluations = 2'000'000;

}  // namespace gonio::bench
