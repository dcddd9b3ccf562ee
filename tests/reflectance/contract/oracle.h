#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "reflectance/surface/make_surface.h"

// The tables that oracle.py wrote, and what they are about.
namespace gonio::reflectance {

/// As the library receives it [rad]: theta or the elevation above the horizon.
struct OracleDirection {
  bool by_elevation;
  double angle;
  double phi;

  [[nodiscard]] Direction direction() const {
    return by_elevation ? Direction::from_elevation(radians(angle), radians(phi))
                        : Direction::from_angles(radians(angle), radians(phi));
  }
};

inline std::ostream& operator<<(std::ostream& out, const OracleDirection& d) {
  return out << (d.by_elevation ? "elevation " : "theta ") << d.angle << " phi " << d.phi << " rad";
}

/// A model with its parameters in the order of its table.
struct OracleSurface {
  const char* model;
  std::array<double, 3> values;

  [[nodiscard]] Surface surface() const {
    for (const ModelSpec& spec : surface_models()) {
      if (spec.name == model) return make_surface(model, named(spec)).value();
    }
    ADD_FAILURE() << "no model " << model;
    return make_surface("lambertian", {{"rho", 0.0}}).value();
  }
  [[nodiscard]] Parameters named(const ModelSpec& spec) const {
    Parameters parameters;
    for (const ParameterSpec& p : spec.parameters) {
      parameters.push_back({std::string(p.name), values[parameters.size()]});
    }
    return parameters;
  }
};

inline std::ostream& operator<<(std::ostream& out, const OracleSurface& s) {
  return out << s.model << " (" << s.values[0] << ", " << s.values[1] << ", " << s.values[2] << ")";
}

inline const OracleSurface kOracleSurfaces[] = {
#include "tests/reflectance/contract/oracle_surfaces.inc"
};

inline ::testing::AssertionResult is_within(double computed, double truth, double relative) {
  const double error = computed == truth ? 0.0 : std::abs(computed - truth) / std::abs(truth);
  if (error <= relative) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << ::testing::PrintToString(computed) << " instead of "
                                       << ::testing::PrintToString(truth) << ": relative error " << error
                                       << ", allowed " << relative;
}

}  // namespace gonio::reflectance
