#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/planner/exposure_choice.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// The frames of one job: which exposure is next, and when there are enough. Pure; the chooser is the scan's.
class Measurement {
 public:
  enum class Verdict : std::uint8_t { More, Done, Saturated };

  /// Frames of a target until the plan's signal-to-noise is reached: a probe if nothing is known, a lower rung after
  /// saturation. Where the plan states exposures: one frame of each, the shortest first, up to the first that saturates
  /// (no frame of that rung counts), then more of the longest that does not. A list that comes down again is gone
  /// through once, without what saturates.
  [[nodiscard]] static Measurement of_item(const ExposureChooser& chooser, calibration::Target target, int filter);
  /// `frames` of each rung from `lowest` to `highest`.
  [[nodiscard]] static Measurement of_dark(std::size_t lowest, std::size_t highest, int frames);

  /// The rung of the next frame.
  [[nodiscard]] std::size_t rung() const { return rung_; }
  [[nodiscard]] Verdict add(ReadingRecord reading, ExposureChooser& chooser);
  /// Whether the frame under way will likely be the last one: by the frames before it, or by what was measured last at
  /// this target and filter and how much that changes from item to item.
  [[nodiscard]] bool expects_no_more(const ExposureChooser& chooser) const;
  /// All frames so far, probes and saturated ones among them (not `used`).
  [[nodiscard]] const std::vector<ReadingRecord>& readings() const { return readings_; }
  /// Of the reading at this place.
  [[nodiscard]] std::size_t rung_of(std::size_t reading) const { return rung_of_reading_[reading]; }
  /// The rungs of those that count, each once, ascending.
  [[nodiscard]] std::vector<std::size_t> used_rungs() const;
  /// How many of a rung's count.
  [[nodiscard]] std::int64_t used_frames_of(std::size_t rung) const;
  /// How many of them count, on the last rung.
  [[nodiscard]] int used_frames() const { return on_rung_; }
  /// Their mean in the aperture.
  [[nodiscard]] double mean_dn() const { return on_rung_ == 0 ? 0.0 : sum_dn_ / on_rung_; }

 private:
  [[nodiscard]] std::optional<ExposureChooser::Signal> expected_signal(const ExposureChooser& chooser) const;
  Verdict add_dark(double mean_dn, ExposureChooser& chooser);
  Verdict add_saturated();
  Verdict add_lit(std::uint32_t pixels, ExposureChooser& chooser);
  Verdict add_stated(const calibration::RegionMoments& region, ExposureChooser& chooser);
  /// A ladder up and down: 1 2 4 4 2 1. Each of its steps has its frames, and none gets more.
  [[nodiscard]] bool comes_down() const { return stated_.size() > 1 && stated_.front() == stated_.back(); }
  Verdict drop_stated_rung(ExposureChooser& chooser);
  Verdict repeat_longest(std::uint32_t pixels, ExposureChooser& chooser);
  void change_rung(std::size_t rung);
  void return_to(std::size_t rung);

  bool is_dark_ = false;
  calibration::Target target_ = calibration::Target::Dark;
  int filter_ = 0;
  std::size_t rung_ = 0;
  std::size_t ceiling_ = 0;
  int dark_frames_ = 0;
  int changes_ = 0;
  int on_rung_ = 0;
  double sum_dn_ = 0.0;
  std::vector<std::size_t> stated_;  ///< by the plan, as far as they do not saturate
  std::size_t tried_ = 0;            ///< of them, how many have a frame
  std::vector<ReadingRecord> readings_;
  std::vector<std::size_t> rung_of_reading_;
};

}  // namespace gonio::daemon
