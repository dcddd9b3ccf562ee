#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "daemon/analysis/stored_scan.h"
#include "daemon/store/point_trace.h"

namespace gonio::analysis {

/// The way from a point's value down to raw readings, as text for people: the value with its calibration, the terms of
/// its budget by component, its attempts with every frame's moments, the visits of the dark on both sides of them, and
/// whether computing it anew from those readings gives the same bits. Errors: NotFound (no such point), those of
/// compute_brdf.
[[nodiscard]] Result<std::string> trace_text(const StoredScan& scan, const daemon::PointTrace& trace,
                                             std::int32_t point, const daemon::NewBrdf& recomputed);

}  // namespace gonio::analysis
