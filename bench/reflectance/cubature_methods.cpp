#include <cubature.h>

#include <numbers>

#include "bench/reflectance/quadrature.h"

namespace gonio::bench {
namespace {

using Integrand = double (*)(const Case&, const reflectance::Direction&, double, double);
using Cubature = decltype(&hcubature);

struct Call {
  const Case* c;
  reflectance::Direction i;
  Integrand integrand;
  std::uint64_t evaluations;
};

int evaluate(unsigned, const double* x, void* data, unsigned, double* value) {
  Call& call = *static_cast<Call*>(data);
  ++call.evaluations;
  *value = call.integrand(*call.c, call.i, x[0], x[1]);
  return 0;
}

Method method(std::string name, Cubature cubature, Integrand integrand, double first_end) {
  const auto rungs = [=](const Case& c) {
    std::vector<Rung> all;
    for (const double tolerance : tolerance_ladder(1e-10, 2)) {
      const auto run = [=, &c, i = c.incidence()] {
        Call call{&c, i, integrand, 0};
        const double least[2] = {0.0, 0.0};
        const double most[2] = {first_end, std::numbers::pi};
        double value = 0.0;
        double error = 0.0;
        cubature(1, evaluate, &call, 2, least, most, kMostEvaluations, 0.0, tolerance, ERROR_INDIVIDUAL, &value,
                 &error);
        return Estimate{value, call.evaluations};
      };
      all.push_back({tolerance_text(tolerance), repeated(run)});
    }
    return all;
  };
  return {std::move(name), Family::Adaptive, rungs};
}

}  // namespace

std::vector<Method> cubature_methods() {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  return {
      method("hcubature (theta, phi)", hcubature, integrand_in_theta, kQuarter),
      method("hcubature (mu, phi)", hcubature, integrand_in_mu, 1.0),
      method("pcubature (theta, phi)", pcubature, integrand_in_theta, kQuarter),
      method("pcubature (mu, phi)", pcubature, integrand_in_mu, 1.0),
  };
}

}  // namespace gonio::bench
