#pragma once

#include <cstdint>
#include <vector>

#include "base/units.h"

namespace gonio::daemon {

/// A number, and the standard deviation of the next one of its kind.
struct Learned {
  double value = 0.0;
  double u = 0.0;
};

/// What a camera sees of a surface of reflectance factor 1 at theta_i = 0.
struct WhiteSignal {
  Wavelength wavelength;
  double dn_per_s = 0.0;  ///< above the dark, the mean in the aperture
};

/// What finished scans of this stage took beside what the axes' numbers say, by cause. Without any, guesses.
struct TimeExperience {
  std::int64_t scans = 0;
  Learned motion{1.0, 0.02};       ///< moves and settling: taken / by the axes' numbers
  Learned beyond_s{0.005, 0.005};  ///< of an item: frames read, waits for the wires, the store and the daemon
  std::vector<WhiteSignal> white;  ///< by wavelength; of what was measured lately
};

}  // namespace gonio::daemon
