#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/units.h"

namespace gonio::sim {

/// What a radiometer looks at: the sample through filters and shutters, or the lamp before all of them.
enum class RadiometerPlace : std::uint8_t { Detector, Monitor };

struct Responsivity {
  Wavelength wavelength;
  double a_per_w = 0.0;
};

/// One range; noise and offset as parts of its full scale.
struct RadiometerRange {
  double full_scale_w = 0.0;
  double noise = 0.0;   ///< standard deviation of one average
  double offset = 0.0;  ///< what it shows in the dark before a zero
};

/// A bench power meter with a photodiode. Times are scene time.
struct RadiometerSpec {
  std::string serial = "SIM-PM-01";
  RadiometerPlace place = RadiometerPlace::Detector;
  double watts = 1e-3;                             ///< on its diode for light (or lamp) 1
  Wavelength lamp_wavelength = nanometres(568.0);  ///< of what a monitor sees
  std::vector<Responsivity> responsivity;          ///< ascending wavelengths; linear between, limits of the setting
  std::vector<RadiometerRange> ranges;             ///< ascending
  double u_range = 0.0;                            ///< relative; each range's gain is drawn once a seed
  double average_s = 0.003;                        ///< one average
  double settle_s = 0.0;                           ///< time constant after a change of range; 0: at once
  double settle_error = 0.05;                      ///< of full scale, right after it
  double zero_s = 0.5;
  double u_window = 0.0;      ///< told to the daemon of a monitor: relative, lamp light that it has at another time
  int averages = 1;           ///< told to the daemon: in each sample
  int samples = 10;           ///< told to the daemon: in each reading
  int readings_at_most = 64;  ///< told to the daemon
};
/// Silicon from 400 nm to 1100 nm, five ranges from 1 uW to 10 mW, without noise, offset and settling.
[[nodiscard]] RadiometerSpec quiet_radiometer();

}  // namespace gonio::sim
