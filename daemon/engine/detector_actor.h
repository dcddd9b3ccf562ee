#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <variant>

#include "base/clock.h"
#include "calibration/frame_reducer.h"
#include "daemon/sequencer/messages.h"
#include "drivers/detector.h"

namespace gonio::daemon {

/// How frames are reduced: what does not depend on their size.
struct FrameReduction {
  calibration::ApertureMask aperture;
  std::shared_ptr<const calibration::DetectorMaps> maps;  ///< nullptr: none
  calibration::DetectorModel noise;
};

/// Drives the detector: settings, trigger, frame, reduction; one request at a time, in the order of asking, each
/// answered once. Blocks as long as the detector's link does (5 s when a camera is gone), so it has its own thread.
/// Threads: one.
class DetectorActor {
 public:
  using Answer = std::variant<FrameAnswer, DetectorAnswer>;
  using Post = std::function<void(Answer)>;
  static constexpr std::size_t kMostWaiting = 16;
  /// How long one look for a frame may block. In a test the link returns at once and the step asks to come again.
  static constexpr Duration kLookTime = std::chrono::milliseconds(20);

  /// `detector` must outlive it. `post` is called from `on` and `step`.
  DetectorActor(drivers::Detector& detector, FrameReduction reduction, Post post);

  void on(const DetectorRequest& request, Instant now);
  [[nodiscard]] std::optional<Instant> step(Instant now);

 private:
  /// A frame that was triggered and has not come yet.
  struct Exposure {
    Ticket ticket = 0;
    Instant next_look{};
    std::shared_ptr<calibration::PixelSums> sums;  ///< of a map job
  };

  void begin(const DetectorRequest& request, Instant now);
  void take(const TakeFrame& request, Instant now);
  void collect(Instant now);
  [[nodiscard]] Result<FrameSummary> summary_of(const drivers::Frame& frame, calibration::PixelSums* sums);
  [[nodiscard]] Result<void> prepare_for(const drivers::Frame& frame);

  drivers::Detector& detector_;
  FrameReduction reduction_;
  Post post_;
  std::deque<DetectorRequest> waiting_;
  std::optional<Exposure> exposure_;
  /// Prepared for the first frame, and again should a frame have another shape.
  struct Prepared {
    int width = 0;
    int height = 0;
    int significant_bits = 0;
    calibration::FrameReducer reducer;
  };
  std::optional<Prepared> prepared_;
};

}  // namespace gonio::daemon
