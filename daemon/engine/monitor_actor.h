#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <variant>

#include "base/clock.h"
#include "daemon/config/power_meter.h"
#include "daemon/engine/power_task.h"
#include "daemon/sequencer/messages.h"
#include "drivers/radiometer.h"

namespace gonio::daemon {

/// Drives a radiometer in the lamp's light, beside the detector: each reading covers the exposure's window from its
/// start on. One request at a time, each answered once within a deadline; on a thread of its own. Threads: one.
class MonitorActor {
 public:
  using Answer = std::variant<MonitorAnswer, MonitorReady>;
  using Post = std::function<void(Answer)>;
  static constexpr std::size_t kMostWaiting = 16;

  /// `radiometer` must outlive it. `post` is called from `on` and `step`.
  MonitorActor(drivers::Radiometer& radiometer, PowerMonitorConfig config, Post post);

  void on(const MonitorRequest& request, Instant now);
  [[nodiscard]] std::optional<Instant> step(Instant now);

 private:
  void begin(const TakeMonitor& request, Instant now);
  void begin(const PrepareMonitor& request, Instant now);
  void look(Instant now);

  drivers::Radiometer& radiometer_;
  PowerMonitorConfig config_;
  PowerTask task_;
  Post post_;
  std::deque<MonitorRequest> waiting_;
  std::optional<Ticket> reading_;
};

}  // namespace gonio::daemon
