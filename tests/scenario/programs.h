#pragma once

#include <chrono>

namespace gonio::test {

// The programs under test, where this build put them, and the scenes of the source.
inline constexpr const char* kGoniosim = GONIO_GONIOSIM;
inline constexpr const char* kGoniod = GONIO_GONIOD;
inline constexpr const char* kGonioctl = GONIO_GONIOCTL;
inline constexpr const char* kGonioAnalyse = GONIO_ANALYSE;
inline constexpr const char* kScenes = GONIO_SCENES;

// Bounds against hanging, far above what a slow, busy machine needs; never a speed to be met.
inline constexpr std::chrono::seconds kStartDeadline{60};
inline constexpr std::chrono::seconds kStepDeadline{120};
inline constexpr std::chrono::seconds kScanDeadline{400};

}  // namespace gonio::test
