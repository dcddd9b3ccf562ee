#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "sim/devices/instrument.h"

namespace gonio::sim {

/// A frame as the camera sends it.
struct CameraFrame {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> pixels;  ///< [height][width]
  std::uint64_t frame_id = 0;         ///< from 1, since the acquisition's start
  Instant exposure_end{};
  Duration exposure{};
  double gain_db = 0.0;
};

/// The frame of a finished exposure. Pure: threads any.
[[nodiscard]] CameraFrame make_frame(const Scene& scene, const Exposure& exposure, std::uint64_t frame_id);

/// The camera without its wire: settings, software trigger, one exposure at a time, no frame kept beyond the last. Wall
/// time. Threads: one at a time, as the instrument.
class CameraModel {
 public:
  /// `instrument` must outlive it.
  explicit CameraModel(Instrument& instrument);

  [[nodiscard]] Duration shortest_exposure() const { return shortest_; }
  [[nodiscard]] Duration longest_exposure() const { return longest_; }
  static constexpr double kMostGainDb = 24.0;

  /// Errors: OutOfLimits; the setting stays as it was.
  [[nodiscard]] Result<void> set_exposure(Duration exposure);
  [[nodiscard]] Result<void> set_gain(double gain_db);
  [[nodiscard]] Duration exposure() const { return exposure_; }
  [[nodiscard]] double gain_db() const { return gain_db_; }
  [[nodiscard]] Temperature temperature(Instant now) const { return instrument_.detector_temperature(now); }

  /// False: an exposure is under way, the trigger is lost.
  bool trigger(Instant now);
  /// When the exposure under way ends.
  [[nodiscard]] std::optional<Instant> ready_at() const { return instrument_.exposure_end(); }
  /// The finished exposure with its frame id, once; its frame is `make_frame`, its statistics `draw_region`.
  [[nodiscard]] std::optional<Exposure> collect_exposure(Instant now);
  /// Both in one step.
  [[nodiscard]] std::optional<CameraFrame> collect(Instant now);
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// A number that no exposure of its own has: for faults.
  std::uint64_t take_frame_id() { return ++frames_; }
  /// The next frame is number 1.
  void restart_frame_ids() { frames_ = 0; }

 private:
  Instrument& instrument_;
  Duration shortest_;
  Duration longest_;
  Duration exposure_;
  double gain_db_ = 0.0;
  std::uint64_t frames_ = 0;
};

}  // namespace gonio::sim
