#pragma once

#include <mutex>
#include <optional>
#include <utility>

#include "base/clock.h"
#include "sim/devices/camera_model.h"
#include "sim/devices/drive_units.h"
#include "sim/devices/instrument.h"
#include "sim/devices/stage_face.h"

namespace gonio::sim {

/// One instrument for several wires at once, in the time of a clock. Threads: any; the lock is a leaf, held for one
/// request at a time.
class LiveInstrument {
 public:
  /// What `with` hands out.
  struct Parts {
    Instrument& instrument;
    StageFace& stage;
    CameraModel& camera;
    ModbusUnits& units;  ///< what is on the stage's wire: `stage`, or drives where the scene has them
    Instant now;
  };

  /// `clock` must outlive it.
  LiveInstrument(Scene scene, InstrumentMemory memory, const Clock& clock)
      : clock_(clock),
        instrument_(std::move(scene), std::move(memory), clock.now()),
        stage_(instrument_),
        camera_(instrument_) {
    if (this->scene().stage.drives) drives_.emplace(instrument_);
  }

  /// Runs `f(Parts&)` alone, with everything that was due having happened.
  template <class F>
  auto with(F&& f) {
    const std::lock_guard lock(mutex_);
    Parts parts{instrument_, stage_, camera_, drives_ ? static_cast<ModbusUnits&>(*drives_) : stage_, clock_.now()};
    instrument_.advance_to(parts.now);
    return std::forward<F>(f)(parts);
  }

  [[nodiscard]] const Clock& clock() const { return clock_; }
  /// Never changes, so it needs no lock.
  [[nodiscard]] const Scene& scene() const { return instrument_.scene(); }

 private:
  const Clock& clock_;
  std::mutex mutex_;
  Instrument instrument_;
  StageFace stage_;
  CameraModel camera_;
  std::optional<DriveUnits> drives_;
};

}  // namespace gonio::sim
