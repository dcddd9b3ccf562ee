#pragma once

#include <string>
#include <utility>
#include <vector>

#include "daemon/planner/planner.h"
#include "daemon/store/records.h"
#include "daemon/store/store_writer.h"
#include "tests/daemon/support/bench_instrument.h"
#include "tests/support/temporary_folder.h"

namespace gonio::daemon::test {

/// A folder of its own, gone with the test.
class ScratchFolder {
 public:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }

 private:
  gonio::test::TemporaryFolder folder_{gonio::test::folder_in_memory()};
};

/// What a client submits for a plan on the bench instrument.
[[nodiscard]] inline NewScan new_scan(const api::Plan& plan, std::string key = {}) {
  const Instrument instrument = bench_instrument();
  const auto planned = expand(plan, instrument);
  return NewScan{.idempotency_key = std::move(key),
                 .name = plan.name,
                 .campaign = "tests",
                 .sample = plan.sample,
                 .isotropic = plan.isotropic,
                 .policy = policy_of(plan),
                 .plan_text = "[scan]\nname = \"bench plan\"\n",
                 .plan_file = "plan.toml",
                 .reference_serial = plan.reference_standard,
                 .reference_text = "[standard]\n",
                 .instrument_text = instrument.text,
                 .instrument_hash = instrument.sha256,
                 .planned = planned.value(),
                 .who = "uid:1000"};
}

[[nodiscard]] inline ReadingRecord reading_of(double mean_dn, Instant at,
                                              Duration exposure = std::chrono::milliseconds(4)) {
  ReadingRecord reading;
  reading.region = {.n = 450, .mean = mean_dn, .m2 = 2.0, .m3 = 0.5, .m4 = 12.0};
  reading.settings.exposure = exposure;
  reading.monitor_mean = 1.0;
  reading.monitor_se = 1e-4;
  reading.monitor_samples = 10;
  reading.at = at;
  return reading;
}

}  // namespace gonio::daemon::test
