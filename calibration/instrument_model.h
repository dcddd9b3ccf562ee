#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/units.h"
#include "calibration/absolute_model.h"
#include "calibration/overlap_model.h"
#include "calibration/power_model.h"

namespace gonio::calibration {

/// Where a reading's noise is taken from.
enum class NoiseSource : std::uint8_t {
  PhotonTransfer,  ///< the model below: as well known as its constants, from one frame on
  RepeatedFrames,  ///< the scatter of the reading's own frames, worth their number less one; a single frame takes the
                   ///< model
};

/// A fitted linearity: light = N (1 + a1 x + a2 x^2 + a3 x^3), x = N / full scale, N net of the dark, in DN (or W of a
/// range). On a camera it acts on each pixel: the region's moments carry the mean through it. Not for readings that
/// maps have linearised already (DetectorMaps::linearity_1).
struct LinearityModel {
  std::vector<double> coefficients;  ///< a1.. of N / full scale; at most 3; empty: straight
  /// Of (a1.., t0 [s]), row by row, (n + 1)^2, symmetric: as the fit of an exposure ladder gives them together. Empty:
  /// known exactly; else exposure_offset_s.u of the detector counts for nothing.
  std::vector<double> covariance;
};

/// The gain that a setting really has, over 10^(dB / 20).
struct GainFactor {
  double gain_db = 0.0;
  Measured<double> factor{1.0, 0.0};
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
  LinearityModel linearity;         ///< corrected; u_linearity is what it leaves
  std::vector<GainFactor> gains;    ///< of settings not named: 1, exactly
  /// Of room light that no ambient visit has measured, DN/s at 0 dB (W of a radiometer); shared.
  double u_ambient_dn_per_s = 0.0;
};

/// Standard uncertainties (k = 1) of the directions, shared by the scan (zeros of the arms) and from move to move.
struct AngleModel {
  Angle u_zero_theta_i;
  Angle u_zero_theta_r;
  Angle u_zero_phi_r;
  Angle u_repeat;  ///< random, each axis, each move
  /// True angle = encoder + zero of (theta_i, theta_r, phi_r), as found by a calibration; corrected.
  std::array<Angle, 3> zero{};
  /// Of the three, row by row, rad^2: often only a difference is known well. All 0: the u_zero above, independent.
  std::array<double, 9> zero_covariance{};
};

/// What is left of the lamp and the placing after the monitor; relative, k = 1.
struct LampModel {
  double u_after_monitor = 0.0;   ///< of the difference of two readings far apart
  double correlation_s = 3600.0;  ///< two readings dt apart: u_after_monitor sqrt(1 - exp(-dt^2 / (2 correlation_s^2)))
  double u_reproducibility = 0.0;  ///< random per reading: placing, fine structure of the surface
  double reproducibility_dof = std::numeric_limits<double>::infinity();  ///< how well u_reproducibility is known
};

/// Light of the lamp that reaches the detector by other ways than the target, in units of what a perfectly white
/// diffuser (f_r = 1 / pi) at normal incidence gives.
struct StrayModel {
  Measured<double> source_share;  ///< the same before sample, standard and black trap; corrected
  /// Of all light that the target sends back (pi times its irradiance times rho_dh), scattered within the detector: no
  /// trap shows it. Never corrected: in the budget only, with pi f in place of the sample's rho_dh.
  Measured<double> internal_share;
};

/// Source and detector as seen from the target: evenly filled caps of directions. The measurand is f_r at zero
/// aperture (cone_correction.h).
struct ConeModel {
  Measured<Angle> source_half;
  Measured<Angle> detector_half;
};

/// The standard deviation of the cosine of an angle of which nothing is known.
inline constexpr double kOfAnyPlane = 0.70710678118654752;

/// What is left of polarisation when one state of light is measured (polarisation_term.h).
struct PolarisationModel {
  double source_degree = 0.0;           ///< linear, of the lamp's light
  double detector_diattenuation = 0.0;  ///< (most - least) / (most + least) of its answers to linear light
  /// Standard uncertainty of the sample's unknown diattenuation (R_s - R_p) / (R_s + R_p) times the cosine of twice the
  /// angle from its plane to the source's or the detector's, which nobody knows; the standard's likewise.
  double u_sample = 0.0;
  double u_reference = 0.0;
  /// A sample of clear facets: its diattenuation is Fresnel's at half the phase angle, times u_sample: kOfAnyPlane
  /// where nothing is known of the planes, less where something is.
  std::optional<double> sample_index;
};

/// How a target stands on its carriage: the normal leans towards phi = 0 and phi = 90 deg, the surface lies above the
/// arms' centre. Stated values are corrected, their u stands in the budget (mounting_term.h).
struct MountModel {
  Measured<Angle> lean_0;
  Measured<Angle> lean_90;
  Measured<Length> height;
  std::string mounting;  ///< names this mounting: what two scans with the same name have in common
};

struct MountingModel {
  MountModel sample;
  MountModel reference;
  Length source_distance = millimetres(600.0);
};

/// What the filter or monochromator lets through: matters through d ln f / d lambda, where neighbouring wavelengths
/// were measured (spectral_term.h).
struct SpectralModel {
  Wavelength u_centroid;  ///< shared by all readings of one wavelength
  Wavelength bandwidth;   ///< full width at half maximum
};

/// The instrument's side of the measurement equation, from instrument.toml and the calibrations that a scan names. What
/// is not there is neither corrected nor in the budget.
struct InstrumentModel {
  DetectorModel detector;
  AngleModel angles;
  LampModel lamp;
  std::optional<StrayModel> stray;
  std::optional<ConeModel> cones;
  std::optional<PolarisationModel> polarisation;
  std::optional<MountingModel> mounting;
  std::optional<SpectralModel> spectral;
  std::optional<OverlapModel> overlap;
  std::optional<AbsoluteModel> absolute;
  std::string version;  ///< names these values: two scans with the same one have their errors in common; "": unknown
};

}  // namespace gonio::calibration
