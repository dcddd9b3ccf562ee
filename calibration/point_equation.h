#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/result.h"
#include "calibration/calibrate.h"
#include "calibration/direction_slopes.h"
#include "calibration/drift_history.h"
#include "calibration/geometry_factor.h"
#include "calibration/instrument_model.h"
#include "calibration/normalised_reading.h"
#include "calibration/reading_pairs.h"
#include "calibration/reference_standard.h"
#include "calibration/scan_histories.h"

namespace gonio::calibration {

/// The standard where its reading was made.
struct StandardView {
  Measured<double> rho;  ///< of the certificate
  double shape = 1.0;
  std::array<double, kDirectionAxes> slope{};  ///< d ln f_ref / d angle, 1/rad
};

/// A sample reading and the reference reading of the same geometry, or what stands in its place, and the value they
/// make. By anchor: the standard's visits at the anchor at the sample's moment. By the direct beam: that beam, with
/// q 1.
struct PairedPoint {
  ReferenceMode mode = ReferenceMode::SameGeometry;
  NormalisedReading sample;  ///< its geometry in the surface's own frame, zeros and mounting corrected
  NormalisedReading reference;
  std::int64_t reference_id = 0;
  bool reference_is_shared = false;  ///< other points use the same reading
  Wavelength wavelength;
  Polarisation polarisation = Polarisation::Any;
  bool is_blocked = false;          ///< PlannedPoint::is_blocked
  bool is_beyond_standard = false;  ///< ReferenceStandard::is_extrapolated
  StandardView standard;
  double geometry_ratio = 1.0;  ///< (mu_i mu_r O)_ref / (mu_i mu_r O)_s (geometry_factor.h), times what a raised
                                ///< surface does to the distance of the source
  std::array<double, kDirectionAxes>
      sample_log_slope{};  ///< d ln q / d angle of all but f_s: -tan(theta_i), 0, 0 in radiance mode
  std::array<double, kDirectionAxes> reference_log_slope{};  ///< of the reference's reading likewise
  double value = 0.0;                                        ///< f_s, sr^-1
  double stray = 0.0;                                        ///< sr^-1 of one unit of stray share: 1 / (pi mu_i,s)
  double drift_ratio = 1.0;                ///< response at the reference's reading / response at the sample's
  double dvalue_dq = 0.0;                  ///< f_ref geometry_ratio drift_ratio / q_ref, with stray light of both
  std::optional<DriftLevel> sample_drift;  ///< nothing: not corrected
  std::optional<DriftLevel> reference_drift;
  std::vector<RelativeTerm> terms;  ///< shared, of the geometries, the anchor's visits or the direct beam
  double u_drift_rest = 0.0;        ///< relative, random: AnchorReading::u_drift_rest
  double drift_rest_dof = std::numeric_limits<double>::infinity();
  bool is_mixed = false;           ///< neither spot nor field of view holds the other
  bool is_anchor_drifted = false;  ///< between two visits beyond the plan's limit
};

/// What the equation of every point of a scan has in common. What it points to must outlive it.
struct EquationContext {
  const ScanHistories* histories = nullptr;
  const InstrumentModel* instrument = nullptr;
  const ReferenceStandard* standard = nullptr;
  LeftOut left_out;
};

/// The measurement equation of one point (calibrate.h), but for what needs its neighbours: the cones.
/// With stray light of a stated share b of white (StrayModel), K the reading of white at normal incidence:
///   q_s = K (pi f_s mu_s + b),  q_ref = K (pi f_ref mu_ref + b)
///   f_s = (q_s / q_ref (pi f_ref mu_ref + b) - b) / (pi mu_s).
/// In anchor mode q_ref is AnchorHistory's; by the direct beam f_s is absolute_factor.h's, without stated stray light.
/// The sample's reading must be there, the reference's in same-geometry mode. Errors: those of normalise, of the
/// standard's reach, of AnchorHistory and absolute_ratio; IncompleteData (no light from the reference).
/// `pair` may have served another point: nothing of that is left but the memory of its lists. Its value is complete,
/// StandardView::slope is 0 until add_standard_slopes.
[[nodiscard]] Result<void> equate(const PlannedPoint& point, const ReadingPair& readings,
                                  const EquationContext& context, PairedPoint& pair);

/// The standard's own slopes, which the value does not need and its budget does.
void add_standard_slopes(const EquationContext& context, PairedPoint& pair);

}  // namespace gonio::calibration
