#pragma once

#include <utility>

#include "sim/devices/radiometer_face.h"
#include "sim/devices/radiometer_model.h"
#include "sim/wires/live_instrument.h"
#include "sim/wires/usbtmc_function.h"

namespace gonio::sim {

/// A radiometer on a live instrument, as a USB device without a bus. Threads: any; the lock is the instrument's.
class LiveRadiometer {
 public:
  /// `instrument` must outlive it.
  LiveRadiometer(LiveInstrument& instrument, RadiometerSpec spec, bool has_interrupt_in = true)
      : instrument_(instrument),
        model_(*instrument.with([](LiveInstrument::Parts& parts) { return &parts.instrument; }), std::move(spec)),
        face_(model_),
        function_(face_, model_.spec().serial, has_interrupt_in) {}

  /// Runs `f(UsbtmcFunction&, Instant now)` alone.
  template <class F>
  auto with(F&& f) {
    return instrument_.with([&](LiveInstrument::Parts& parts) { return std::forward<F>(f)(function_, parts.now); });
  }

  /// Runs `f(Instrument&, Instant now)` alone.
  template <class F>
  auto with_instrument(F&& f) {
    return instrument_.with(
        [&](LiveInstrument::Parts& parts) { return std::forward<F>(f)(parts.instrument, parts.now); });
  }

  [[nodiscard]] const Clock& clock() const { return instrument_.clock(); }

 private:
  LiveInstrument& instrument_;
  RadiometerModel model_;
  RadiometerFace face_;
  UsbtmcFunction function_;
};

}  // namespace gonio::sim
