#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "base/geometry.h"
#include "base/result.h"
#include "calibration/background_history.h"
#include "calibration/dark_history.h"
#include "calibration/instrument_model.h"
#include "calibration/left_out.h"
#include "calibration/linearity.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// What a reading is cleared with. What it points to must outlive it.
struct ReadingContext {
  const DarkHistory* darks = nullptr;          ///< never null
  const DetectorModel* detector = nullptr;     ///< never null
  const BackgroundHistory* ambient = nullptr;  ///< null: not subtracted
  const BackgroundHistory* stray = nullptr;    ///< null: not subtracted
  LeftOut left_out;
};

/// One reading, cleared of dark, exposure, gain, lamp and background:
///   q = sum_j (Lin^-1(S_j - D_j) - a E_j) / sum_j (E_j m_j) - b,   E_j = (t_j + t0) G_j,     over its frames j,
/// in DN per second and unit of the monitor; signed; a the ambient and b the stray light where visits found them. A
/// radiometer has no exposure: E = 1 / G of its range, in W per unit of the monitor. The ratio of sums weighs frames as
/// their light does, so that frames of different exposures combine as their shot noise asks.
struct NormalisedReading {
  double q = 0.0;
  double u_noise = 0.0;  ///< of q, random: by photon transfer, or from the frames' own scatter
  double noise_dof = std::numeric_limits<double>::infinity();  ///< how well u_noise is known
  double u_monitor = 0.0;                                      ///< of q: the monitor's noise over the exposures, random
  double dlnq_dt0 = 0.0;                                       ///< 1/s
  double mean_net_dn = 0.0;  ///< of a pixel of a frame, or as part of the range: what linearity depends on
  double frame_chi2 = 0.0;   ///< of its frames about q, by the noise model; `frame_dof` degrees of freedom
  double frame_dof = 0.0;
  bool has_saturated = false;                           ///< exposures of it were saturated and left out
  std::vector<DarkShare> darks;                         ///< one each rung, ascending
  std::array<double, kLinearityTerms> dq_dlinearity{};  ///< of each coefficient of LinearityModel
  double dq_dambient = 0.0;                             ///< of the ambient level
  std::optional<BackgroundLevel> ambient;               ///< subtracted
  std::optional<BackgroundLevel> stray;                 ///< subtracted: dq/db = -1
  Geometry geometry;                                    ///< reported: mean of open and close over the frames
  Instant at{};
};

/// An exposure with a saturated pixel in the aperture is left out with all its frames and all longer ones: dropping the
/// pixel, or that frame alone, would bias the mean. Errors: Saturated (no shorter exposure is left); IncompleteData (no
/// frame, no pixel, no light on the monitor, or no dark at this exposure and gain). Variance of a pixel of a frame, in
/// DN^2: dark part + net / K (EMVA 1288 release 4.0, eq 5), K = electrons_per_dn.
[[nodiscard]] Result<NormalisedReading> normalise(const RawReading& reading, const ReadingContext& context);
/// Likewise, into memory that has served another reading; after an error nothing in it counts.
[[nodiscard]] Result<void> normalise(const RawReading& reading, const ReadingContext& context, NormalisedReading& out);
/// Without any background. Both must outlive the call.
[[nodiscard]] Result<NormalisedReading> normalise(const RawReading& reading, const DarkHistory& darks,
                                                  const DetectorModel& detector);

}  // namespace gonio::calibration
