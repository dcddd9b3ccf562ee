#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "base/units.h"
#include "calibration/power_model.h"

namespace gonio::calibration {

/// Where a reading's noise is taken from.
enum class NoiseSource : std::uint8_t {
  PhotonTransfer,  ///< the model below: as well known as its constants, from one frame on
  RepeatedFrames,  ///< the scatter of the reading's own frames, worth their number less one; a single frame takes the
                   ///< model
};

/// What calibration knows of the detector: a photon-transfer model (EMVA 1288) and its uncertainties, all k = 1.
struct DetectorModel {
  double electrons_per_dn = 1.0;  ///< at 0 dB
  double read_noise_dn = 0.0;     ///< standard deviation of one pixel of one frame, quantisation included
  double full_scale_dn = 4095.0;
  Measured<double> exposure_offset_s{};  ///< t0: the light falls for exposure + t0
  double u_linearity = 0.0;              ///< relative, at full scale, error growing with the signal; shared by the scan
  /// Of exposure: what interpolation between two darks may miss; shared between them.
  double u_dark_drift_dn_per_s = 0.0;
  NoiseSource noise = NoiseSource::PhotonTransfer;
  /// Relative, random in each frame: lamp light that the monitor did not have in the same window; 0 for one that is
  /// gated by the exposure itself.
  double u_monitor_window = 0.0;
  std::optional<PowerModel> power;  ///< a radiometer: then full_scale_dn is 1, of its range
};

/// Standard uncertainties (k = 1) of the directions, shared by the scan (zeros of the arms) and from move to move.
struct AngleModel {
  Angle u_zero_theta_i;
  Angle u_zero_theta_r;
  Angle u_zero_phi_r;
  Angle u_repeat;  ///< random, each axis, each move
};

/// What is left of the lamp and the placing after the monitor; relative, k = 1.
struct LampModel {
  double u_after_monitor = 0.0;   ///< of the difference of two readings far apart
  double correlation_s = 3600.0;  ///< two readings dt apart: u_after_monitor sqrt(1 - exp(-dt^2 / (2 correlation_s^2)))
  double u_reproducibility = 0.0;  ///< random per reading: placing, fine structure of the surface
  double reproducibility_dof = std::numeric_limits<double>::infinity();  ///< how well u_reproducibility is known
};

/// The instrument's side of the measurement equation, from instrument.toml.
struct InstrumentModel {
  DetectorModel detector;
  AngleModel angles;
  LampModel lamp;
};

}  // namespace gonio::calibration
