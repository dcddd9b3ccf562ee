#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "daemon/analysis/picture.h"
#include "daemon/analysis/stored_scan.h"
#include "daemon/store/scan_history.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::analysis {

/// Lobe, polar map and cut of each channel, at most four of them (spread over all). Where the points make no surface
/// only the cut is drawn; `notes` says so, and which channels are left out.
[[nodiscard]] std::vector<Picture> pictures_of(const formats::MeasuredBrdf& brdf, const std::string& stem,
                                               std::vector<std::string>& notes);

/// Budget and course of a stored scan.
[[nodiscard]] std::vector<Picture> pictures_of_scan(const StoredScan& scan, const daemon::ScanHistory& history,
                                                    const std::string& stem);

}  // namespace gonio::analysis
