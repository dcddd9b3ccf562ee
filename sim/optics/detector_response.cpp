#include "sim/optics/detector_response.h"

#include <cmath>

namespace gonio::sim {

double response(const ResponseSpec& spec, double x) {
  const double bent = x * (1.0 + x * (spec.quadratic + spec.cubic * x));
  if (!spec.knee || bent <= *spec.knee) return bent;
  const double room = spec.saturation - *spec.knee;
  return *spec.knee - room * std::expm1(-(bent - *spec.knee) / room);
}

}  // namespace gonio::sim
