#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/toml_reader.h"
#include "base/units.h"

namespace gonio::api {

struct Plan;

/// What a scan is measured for, beside its BRDF.
enum class CalibrationJob : std::uint8_t {
  Linearity,
  ArmZeros,
  CheckStandard,
  DirectBeam,
  Transfer,
  DarkMap,
  FlatField,
  Signature
};
inline constexpr std::array<std::string_view, 8> kCalibrationJobNames{
    "linearity", "arm-zeros", "check-standard", "direct-beam", "transfer", "dark-map", "flat-field", "signature"};
[[nodiscard]] constexpr std::string_view calibration_job_name(CalibrationJob job) {
  return kCalibrationJobNames[static_cast<std::size_t>(job)];
}

/// Whether it makes maps of the detector's pixels: its scan keeps sums of frames, pixel by pixel.
[[nodiscard]] constexpr bool makes_maps(CalibrationJob job) {
  return job == CalibrationJob::DarkMap || job == CalibrationJob::FlatField;
}

/// Whether the detector looks into the source, with nothing on the stage: its plan's mode is absolute.
[[nodiscard]] constexpr bool looks_into_source(CalibrationJob job) {
  return job == CalibrationJob::DirectBeam || job == CalibrationJob::Signature;
}

/// [calibration] of a plan.
struct PlanCalibration {
  CalibrationJob job = CalibrationJob::CheckStandard;
  int order = 2;    ///< linearity: of the polynomial
  Angle u_mirror;   ///< arm-zeros: of the mirror's normal against a sample's, k = 1
  int frames = 32;  ///< dark-map, flat-field: of each exposure, in each dark visit
};

/// Reads the section, where there is one, into `plan.calibration`; of arm-zeros, direct-beam and signature also the
/// points, which are the job's own. A direct beam stands against no standard: its plan's mode becomes absolute.
/// True when it gave the points: the plan then has no [geometry]. Errors are recorded in the reader.
[[nodiscard]] bool read_calibration(TomlReader& root, Plan& plan);

/// A job that looks into the source has no visits of any target: mode and [visits] of its plan say nothing else. Errors
/// are recorded in the reader.
void refuse_targets_beside_a_beam(TomlReader& root, const Plan& plan);

/// A flat field needs stated exposures and readings of the standard at its own geometries. Errors are recorded in the
/// reader.
void check_flat_field(TomlReader& root, const Plan& plan);

/// A linearity's exposures, ascending until here, climb and come down again. Errors are recorded in the reader.
void make_ladder(TomlReader& root, Plan& plan);

}  // namespace gonio::api
