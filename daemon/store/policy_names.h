#pragma once

#include <array>
#include <string_view>

namespace gonio::daemon {

/// How api::OnItemError, api::OnRestart and api::ReferenceMode are stored, in the order of their enumerators.
inline constexpr std::array<std::string_view, 3> kOnItemErrorNames{"skip", "hold", "fail"};
inline constexpr std::array<std::string_view, 2> kOnRestartNames{"resume", "hold"};
inline constexpr std::array<std::string_view, 3> kReferenceModeNames{"same-geometry", "anchor", "absolute"};

}  // namespace gonio::daemon
