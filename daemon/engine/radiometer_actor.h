#pragma once

#include <deque>
#include <functional>
#include <optional>

#include "base/clock.h"
#include "daemon/config/power_meter.h"
#include "daemon/engine/detector_actor.h"
#include "daemon/engine/power_task.h"
#include "daemon/sequencer/messages.h"
#include "drivers/radiometer.h"

namespace gonio::daemon {

/// Drives a radiometer in the camera's place: answers what DetectorActor answers, with readings in W. One request at a
/// time, in the order of asking, each answered once within a deadline. Blocks as long as the meter's link does, so it
/// has its own thread. Threads: one.
class RadiometerActor {
 public:
  using Answer = DetectorActor::Answer;
  using Post = DetectorActor::Post;
  static constexpr std::size_t kMostWaiting = 16;

  /// `radiometer` must outlive it. `post` is called from `on` and `step`.
  RadiometerActor(drivers::Radiometer& radiometer, PowerDetectorConfig config, Post post);

  void on(const DetectorRequest& request, Instant now);
  [[nodiscard]] std::optional<Instant> step(Instant now);

 private:
  struct Reading {
    TakeFrame request;
  };
  struct Zeroing {
    Ticket ticket = 0;
    Instant next_look{};
    Instant deadline{};
  };

  void begin(const TakeFrame& request, Instant now);
  void begin(const PrepareDetector& request, Instant now);
  void begin(const ZeroDetector& request, Instant now);
  void look_at_reading(Instant now);
  void look_at_zero(Instant now);
  void answer(const TakeFrame& request, Result<FrameSummary> frame);
  [[nodiscard]] std::optional<Instant> next_look() const;

  drivers::Radiometer& radiometer_;
  PowerDetectorConfig config_;
  PowerTask task_;
  Post post_;
  drivers::DetectorIdentity identity_;
  std::deque<DetectorRequest> waiting_;
  std::optional<Reading> reading_;
  std::optional<Zeroing> zeroing_;
};

}  // namespace gonio::daemon
