#include "tests/coverage/leave_out.h"

#include <algorithm>
#include <vector>

namespace gonio::coverage {

using calibration::RawFrame;
using calibration::RawReading;
using calibration::Target;

namespace {

void flatten(calibration::ReferenceDefinition& reference) {
  for (calibration::SpectralShape& shape : reference.shapes) {
    const calibration::ShapeTable& table = shape.table;
    shape.table = calibration::ShapeTable(table.theta_i(), table.theta_r(), table.phi(),
                                          std::vector<double>(table.values().size(), 1.0));
  }
}

void forget_dark_current(RawReading& dark) {
  const auto shortest = std::ranges::min_element(dark.frames, {}, &RawFrame::exposure_s);
  const double level = shortest->region.mean;
  for (RawFrame& frame : dark.frames) frame.region.mean = level;
}

}  // namespace

const char* correction_name(Correction correction) {
  switch (correction) {
    case Correction::Dark:
      return "dark";
    case Correction::Ambient:
      return "ambient light";
    case Correction::Stray:
      return "stray light";
    case Correction::Linearity:
      return "linearity";
    case Correction::ExposureOffset:
      return "t0";
    case Correction::Monitor:
      return "monitor";
    case Correction::Visits:
      return "visits";
    case Correction::Shape:
      return "shape of the reference";
    case Correction::Cones:
      return "cones";
    case Correction::Overlap:
      return "overlap";
    case Correction::Correlation:
      return "correlation";
  }
  return "";
}

std::vector<LeftOutCase> left_out_cases() {
  return {{Correction::Dark, "dark"},
          {Correction::Ambient, "ambient"},
          {Correction::Stray, "stray"},
          {Correction::Linearity, "nonlinear"},
          {Correction::ExposureOffset, "exposure_offset"},
          {Correction::Monitor, "drifted_lamp"},
          {Correction::Visits, "unseen_drift"},
          {Correction::Shape, "lambertian"},
          {Correction::Cones, "wide_cones"},
          {Correction::Overlap, "anchor"},
          {Correction::Correlation, "lambertian"}};
}

void leave_out(Correction correction, PreparedScene& scene) {
  if (correction == Correction::ExposureOffset) scene.told.detector.exposure_offset_s.value = 0.0;
  if (correction == Correction::Linearity) {
    std::ranges::fill(scene.told.detector.linearity.coefficients, 0.0);
  }
  if (correction == Correction::Shape) flatten(scene.reference);
}

void leave_out(Correction correction, calibration::ScanReadings& readings) {
  for (RawReading& reading : readings.readings) {
    if (correction == Correction::Dark && reading.target == Target::Dark) forget_dark_current(reading);
    if (correction != Correction::Monitor) continue;
    for (RawFrame& frame : reading.frames) frame.monitor_mean = 1.0;
  }
  std::erase_if(readings.readings, [&](const RawReading& r) {
    return (correction == Correction::Visits && r.visited_point) ||
           (correction == Correction::Ambient && r.target == Target::Ambient) ||
           (correction == Correction::Stray && r.target == Target::Trap);
  });
}

}  // namespace gonio::coverage
