#pragma once

#include <optional>
#include <vector>

#include "base/result.h"
#include "tests/coverage/coverage_figures.h"
#include "tests/coverage/coverage_scene.h"
#include "tests/coverage/leave_out.h"

namespace gonio::coverage {

struct CampaignOptions {
  int repetitions = 300;
  int threads = 1;
  std::optional<Correction> left_out{};
};

/// Independent repetitions of one scene: repetition n has the seed first_seed + n, from which all of its chance comes,
/// and stands at index n, whatever the number of threads. Errors: the first of `calibrate`.
[[nodiscard]] Result<std::vector<RepetitionOutcome>> run_campaign(const PreparedScene& scene,
                                                                  const CampaignOptions& options);

}  // namespace gonio::coverage
