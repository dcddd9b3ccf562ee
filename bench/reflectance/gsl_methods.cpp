#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>

#include <limits>
#include <memory>
#include <numbers>

#include "bench/reflectance/quadrature.h"

namespace gonio::bench {
namespace {

constexpr std::size_t kIntervals = 1000;

// QAGS with its workspace: Gauss-Kronrod 21, intervals halved, extrapolated.
class Qags {
 public:
  double operator()(gsl_function& f, double end, double tolerance) {
    double value = 0.0;
    double error = 0.0;
    gsl_integration_qags(&f, 0.0, end, 0.0, tolerance, kIntervals, workspace_.get(), &value, &error);
    return value;
  }

 private:
  struct Free {
    void operator()(gsl_integration_workspace* w) const { gsl_integration_workspace_free(w); }
  };
  std::unique_ptr<gsl_integration_workspace, Free> workspace_{gsl_integration_workspace_alloc(kIntervals)};
};

// CQUAD with its workspace: doubly adaptive Clenshaw-Curtis.
class Cquad {
 public:
  double operator()(gsl_function& f, double end, double tolerance) {
    double value = 0.0;
    gsl_integration_cquad(&f, 0.0, end, 0.0, tolerance, workspace_.get(), &value, nullptr, nullptr);
    return value;
  }

 private:
  struct Free {
    void operator()(gsl_integration_cquad_workspace* w) const { gsl_integration_cquad_workspace_free(w); }
  };
  std::unique_ptr<gsl_integration_cquad_workspace, Free> workspace_{gsl_integration_cquad_workspace_alloc(100)};
};

// phi inside theta, the inner integral ten times closer than the outer asks.
template <class Rule>
struct Nested {
  const Case& c;
  reflectance::Direction i;
  double tolerance;
  Rule outer_rule{};
  Rule inner_rule{};
  double theta = 0.0;
  std::uint64_t evaluations = 0;

  static double at_phi(double phi, void* self) {
    Nested& n = *static_cast<Nested*>(self);
    // Once the bound is passed the run is lost; zeros let it end soon.
    return ++n.evaluations > kMostEvaluations ? 0.0 : integrand_in_theta(n.c, n.i, n.theta, phi);
  }
  static double at_theta(double theta, void* self) {
    Nested& n = *static_cast<Nested*>(self);
    n.theta = theta;
    gsl_function f{&at_phi, self};
    return n.inner_rule(f, std::numbers::pi, 0.1 * n.tolerance);
  }
  Estimate run() {
    gsl_function f{&at_theta, this};
    const double value = outer_rule(f, 0.5 * std::numbers::pi, tolerance);
    return {evaluations > kMostEvaluations ? std::numeric_limits<double>::quiet_NaN() : value, evaluations};
  }
};

template <class Rule>
Method method(std::string name) {
  const auto rungs = [](const Case& c) {
    gsl_set_error_handler_off();  // an unreached tolerance is seen in the measured error
    std::vector<Rung> all;
    for (const double tolerance : tolerance_ladder(1e-9, 2)) {
      const auto run = [&c, i = c.incidence(), tolerance] { return Nested<Rule>{c, i, tolerance}.run(); };
      all.push_back({tolerance_text(tolerance), repeated(run)});
    }
    return all;
  };
  return {std::move(name), Family::Adaptive, rungs};
}

}  // namespace

std::vector<Method> gsl_methods() {
  return {method<Qags>("GSL QAGS in QAGS"), method<Cquad>("GSL CQUAD in CQUAD")};
}

}  // namespace gonio::bench
