#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "calibration/component_table.h"
#include "calibration/instrument_model.h"
#include "calibration/left_out.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// One standard deviation of a shared component, as a relative change of f_s.
struct RelativeTerm {
  ComponentTable::Key key;
  std::string name;
  double u = 0.0;  ///< k = 1, in `unit`
  std::string unit;
  std::string owner;                                                    ///< as Component::owner
  double per_sd = 0.0;                                                  ///< d ln f_s, signed
  double degrees_of_freedom = std::numeric_limits<double>::infinity();  ///< of u
  bool is_pattern_known = true;                                         ///< as Component::is_pattern_known
  bool is_of_the_wander = false;                                        ///< likewise
  bool divides = false;  ///< an error of the divisor q_ref, of which f_s has -per_sd
};

/// Whose the instrument's errors are: Component::owner.
[[nodiscard]] inline std::string owner_of(const InstrumentModel& instrument) {
  return instrument.version.empty() ? std::string() : "instrument " + instrument.version;
}

/// What h = mu_i mu_r O of the sample's and the reference's reading makes of their ratio.
struct GeometryRatio {
  double factor = 1.0;                      ///< h(reference) / h(sample)
  std::array<double, 3> sample_slope{};     ///< d ln h / d (theta_i, theta_r, phi_r) at the sample's directions, 1/rad
  std::array<double, 3> reference_slope{};  ///< likewise at the reference's
  bool is_mixed = false;                    ///< at either, neither spot nor field of view holds the other
  std::vector<RelativeTerm> terms;          ///< radii, unevenness, offset; where they do not cancel
};

/// q = K f_r mu_i mu_r O, K the same for sample and standard. Where the instrument states spot and field of view, O is
/// that of overlap.h (by the measured profiles, where there are such: profile_overlap.h) on sample and reference of
/// their own radii; else the field is taken to lie within the spot and h = mu_i (Mobley 2005, footnote 5).
/// Sensitivities to the radii and to the beams' falloff are those of evenly filled discs. The offset of the spot
/// changes O in second order only: its term is what O loses at one standard deviation, times sqrt(3) for the mean of
/// the fourth power; nothing is corrected. With `left_out.overlap` the factor is that of h = mu_i, the budget
/// unchanged. Threads: any.
[[nodiscard]] GeometryRatio geometry_ratio(const Geometry& sample, const Geometry& reference,
                                           const InstrumentModel& instrument, const LeftOut& left_out = {});

/// One reading's own side, where nothing stands against it: the direct beam has no geometry.
struct GeometryTerms {
  double factor = 1.0;            ///< pi spot radius^2 / (mu_i mu_r O): 1 / mu_r with the spot inside the field
  std::array<double, 3> slope{};  ///< d ln (mu_i mu_r O) / d (theta_i, theta_r, phi_r)
  bool is_mixed = false;
  std::vector<RelativeTerm> terms;
};
/// Of the sample. Where the field lies within the spot it rests on the square of the ratio of both radii. `instrument`
/// states spot and field of view (asserted).
[[nodiscard]] GeometryTerms absolute_geometry(const Geometry& sample, const InstrumentModel& instrument);

}  // namespace gonio::calibration
