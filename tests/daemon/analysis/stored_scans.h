#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "calibration/calibrated_scan.h"
#include "daemon/store/store_reader.h"
#include "daemon/store/store_writer.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::analysis::test {

/// A store with scans whose values a test makes up: what lies behind them is not the point here.
class StoredValues {
 public:
  /// `value` of a geometry, sr^-1.
  template <class Value>
  StoredValues(const api::Plan& plan, Value value, std::uint32_t flags = 0) : id_(add(plan, value, flags)) {}

  /// One more scan, of the same instrument and standard.
  template <class Value>
  daemon::ScanId add(const api::Plan& plan, Value value, std::uint32_t flags = 0) {
    daemon::NewScan scan = daemon::test::new_scan(plan);
    daemon::NewBrdf brdf{
        .code_version = "test", .inputs_json = "{}", .component_names = {"certificate [shared, u in 1]"}};
    for (daemon::ScanPoint& point : scan.planned.points) {
      point.blocked = false;  // a bright reading in the shadow is what the tests look for
      const double f = value(point.geometry);
      brdf.rows.push_back({.point = point.index,
                           .value_per_sr = f,
                           .u_random_per_sr = 0.001,
                           .flags = flags,
                           .reported = point.geometry,
                           .sensitivities_per_sr = {0.0, 0.01 * f}});
    }
    brdf.scan = commit({std::move(scan)});
    const daemon::ScanId id = brdf.scan;
    commit({std::move(brdf)});
    return id;
  }

  /// One whose BRDF has no value.
  daemon::ScanId add_empty(const api::Plan& plan) {
    const daemon::ScanId id = commit({daemon::test::new_scan(plan)});
    commit({daemon::NewBrdf{.scan = id, .code_version = "test", .inputs_json = "{}"}});
    return id;
  }

  /// As if it had been measured to its end.
  void end(daemon::ScanId id) {
    using enum daemon::ScanState;
    for (const auto& [from, to] : {std::pair{Queued, Preparing}, std::pair{Preparing, Running},
                                   std::pair{Running, Finishing}, std::pair{Finishing, Done}}) {
      commit({daemon::ScanTransition{.scan = id, .from = from, .to = to, .who = "test"}});
    }
  }

  [[nodiscard]] const std::string& file() const { return path_; }
  [[nodiscard]] daemon::ScanId id() const { return id_; }

 private:
  daemon::ScanId commit(std::vector<daemon::StoreWrite> writes) {
    const auto receipt = writer_->commit({.at = clock_.now(), .writes = std::move(writes), .events = {}});
    EXPECT_TRUE(receipt) << describe(receipt.error());
    return receipt ? receipt->new_scan : 0;
  }

  daemon::test::ScratchFolder folder_;
  std::string path_ = folder_.file("store.sqlite");
  ManualClock clock_;
  std::unique_ptr<daemon::StoreWriter> writer_ =
      std::move(daemon::StoreWriter::open({.path = path_, .boot_id = "boot", .version = "test"}, clock_)).value();
  daemon::ScanId id_;  // last: the first scan is stored by what stands above
};

/// 0.05 everywhere, and 1 at (30, 30, 0); no shadow stands in the way of the plan that goes with it.
[[nodiscard]] inline double bright_at_retro(const Geometry& g) {
  const auto is = [](Angle a, double deg) { return std::abs(in_degrees(a) - deg) < 1e-9; };
  return is(g.theta_i, 30.0) && is(g.theta_r, 30.0) && is(g.phi_r, 0.0) ? 1.0 : 0.05;
}

}  // namespace gonio::analysis::test
