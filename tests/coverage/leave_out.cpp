#include "tests/coverage/leave_out.h"

#include <algorithm>
#include <vector>

namespace gonio::coverage {

using calibration::RawFrame;
using calibration::RawReading;
using calibration::Target;

namespace {

void flatten(calibration::ReferenceDefinition& reference) {
  const calibration::ShapeTable& shape = reference.shape;
  reference.shape = calibration::ShapeTable(shape.theta_i(), shape.theta_r(), shape.phi(),
                                            std::vector<double>(shape.values().size(), 1.0));
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
    case Correction::Correlation:
      return "correlation";
  }
  return "";
}

void leave_out(Correction correction, PreparedScene& scene) {
  if (correction == Correction::ExposureOffset) scene.told.detector.exposure_offset_s.value = 0.0;
  if (correction == Correction::Shape) flatten(scene.reference);
}

void leave_out(Correction correction, calibration::ScanReadings& readings) {
  for (RawReading& reading : readings.readings) {
    if (correction == Correction::Dark && reading.target == Target::Dark) forget_dark_current(reading);
    if (correction != Correction::Monitor) continue;
    for (RawFrame& frame : reading.frames) frame.monitor_mean = 1.0;
  }
  if (correction != Correction::Visits) return;
  std::erase_if(readings.readings, [](const RawReading& r) { return r.visited_point.has_value(); });
}

}  // namespace gonio::coverage
