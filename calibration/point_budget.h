#pragma once

#include <cstdint>
#include <optional>

#include "calibration/budget.h"
#include "calibration/component_table.h"
#include "calibration/direction_slopes.h"
#include "calibration/drift_history.h"
#include "calibration/instrument_model.h"
#include "calibration/normalised_reading.h"
#include "calibration/reference_standard.h"

namespace gonio::calibration {

/// A sample reading and the reference reading of the same geometry, and the value they make.
struct PairedPoint {
  NormalisedReading sample;
  NormalisedReading reference;
  std::int64_t reference_id = 0;
  bool reference_is_shared = false;  ///< other points use the same reading
  Wavelength wavelength;
  Measured<double> rho;                    ///< of the certificate
  double cosine_ratio = 1.0;               ///< mu_i,ref / mu_i,s
  double value = 0.0;                      ///< f_s, sr^-1
  double drift_ratio = 1.0;                ///< response at the reference's reading / response at the sample's
  double dvalue_dq = 0.0;                  ///< f_ref cosine_ratio drift_ratio / q_ref
  std::optional<DriftLevel> sample_drift;  ///< nothing: not corrected
  std::optional<DriftLevel> reference_drift;
};

/// u(f_s) of the readings' own noise, placing included: what scatters from point to point. sr^-1.
[[nodiscard]] Brdf scatter(const PairedPoint& point, const InstrumentModel& instrument);

/// All terms of u(f_s) as listed in calibrate.h. New components join `table`.
[[nodiscard]] Budget point_budget(const PairedPoint& point, const DirectionSlopes& slopes,
                                  const InstrumentModel& instrument, const ReferenceStandard& standard,
                                  ComponentTable& table);

}  // namespace gonio::calibration
