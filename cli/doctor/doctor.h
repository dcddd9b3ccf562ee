#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/daemon_client.h"
#include "cli/doctor/finding.h"
#include "protocol/api/instrument_report.h"

namespace gonio::cli {

struct DoctorOptions {
  bool move = false;  ///< move each axis and back, and STOP once
  std::string today;  ///< "2026-11-22", against which certificates are held
  std::string own_version;
};

/// The commissioning checks of docs/hardware.md, in their order, over the daemon's API alone. Without `move` nothing is
/// changed. Each finding is told as it comes. A check that cannot be tried is skipped and says why; the walk goes on.
/// Threads: one.
class Doctor {
 public:
  using Tell = std::function<void(const Finding&)>;
  /// Opens a second way to the daemon, for STOP while a move waits. Errors: NoDaemon.
  using OpenAnother = std::function<Result<DaemonClient>()>;

  Doctor(DaemonClient& client, OpenAnother open_another, DoctorOptions options, Tell tell);

  /// Whether nothing failed. Errors: NoDaemon and the like, when there is nobody to ask.
  [[nodiscard]] Result<bool> run();

 private:
  void note(const Finding& finding);
  void note_all(const std::vector<Finding>& findings);
  void skip(const std::string& check, const std::string& why);
  [[nodiscard]] Result<void> look();
  [[nodiscard]] Result<api::StatusReport> status_with_stage();
  void try_motion();
  void try_axis(const api::AxisLimits& axis);
  bool try_way(const api::AxisLimits& axis, double to);
  [[nodiscard]] Result<double> move(const api::AxisLimits& axis, double to);
  [[nodiscard]] Result<double> position(const std::string& axis);
  void try_readings();
  void try_stop();
  void wait_until_underway(const api::AxisLimits& axis, double standing, double at_most_s);

  DaemonClient& client_;
  OpenAnother open_another_;
  DoctorOptions options_;
  Tell tell_;
  api::InstrumentReport instrument_;
  bool may_move_ = false;
  bool has_failed_ = false;
};

}  // namespace gonio::cli
