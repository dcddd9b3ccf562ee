#include "sim/scene/radiometer_spec.h"

namespace gonio::sim {

RadiometerSpec quiet_radiometer() {
  RadiometerSpec spec;
  // A typical silicon photodiode.
  spec.responsivity = {{nanometres(400.0), 0.12},  {nanometres(500.0), 0.25}, {nanometres(600.0), 0.36},
                       {nanometres(700.0), 0.45},  {nanometres(800.0), 0.53}, {nanometres(900.0), 0.59},
                       {nanometres(1000.0), 0.55}, {nanometres(1100.0), 0.18}};
  for (const double full_scale : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) spec.ranges.push_back({.full_scale_w = full_scale});
  return spec;
}

}  // namespace gonio::sim
