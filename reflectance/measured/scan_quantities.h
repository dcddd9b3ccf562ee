#pragma once

#include <optional>
#include <vector>

#include "base/result.h"
#include "reflectance/light/light.h"
#include "reflectance/measured/cap_model.h"
#include "reflectance/measured/interpolate_scan.h"
#include "reflectance/measured/measured_scan.h"
#include "reflectance/measured/pair_nodes.h"
#include "reflectance/measured/scan_quantity.h"

namespace gonio::reflectance {

/// The reflectances of a scan, each a weighted sum of its readings (JCGM 100:2008, 5.2):
///   Q = sum w_j f_j + what is modelled,  u^2 = sum (w_j u_random,j)^2 + sum_k (sum_j w_j c_kj)^2 + the other parts,
/// the w_j being those of the interpolation and, where a fitted cap stands in, of the fit's own dependence on the
/// readings. Where nothing was measured stands the cap model, or without one the interpolant's continuation. Immutable;
/// threads: any.
class ScanQuantities {
 public:
  /// Errors: as `check` and `interpolate_scan`; InvalidInput for a cap whose `per_reading` are not as many as the
  /// points.
  [[nodiscard]] static Result<ScanQuantities> make(MeasuredScan scan, const InterpolationOptions& options = {},
                                                   std::optional<CapModel> cap = std::nullopt);

  /// Under light from i. Some 10 ms. Errors: InvalidInput when i lies beyond the measured incidences by more than the
  /// table's `widest_incidence_step` and there is no cap model.
  [[nodiscard]] Result<ScanQuantity> rho_dh(const Direction& i) const;
  /// Towards r, under light from all directions alike. Errors: as `bond_albedo`.
  [[nodiscard]] Result<ScanQuantity> rho_hd(const Direction& r) const;
  /// A, the spherical or Bond albedo. Errors: InvalidInput for a scan of one theta_i only, without a cap model.
  [[nodiscard]] Result<ScanQuantity> bond_albedo() const;
  /// pi f for light from the normal. Errors: as rho_dh.
  [[nodiscard]] Result<ScanQuantity> radf_normal_incidence(const Direction& r) const;
  /// R = E_u / E_d under this light. Errors: as `bond_albedo` unless the light is one beam or disk, then as rho_dh; as
  /// `light_nodes`.
  [[nodiscard]] Result<ScanQuantity> reflectance_under(const Light& light) const;
  /// R_rs(r) = L_r(r) / E_d. Errors: likewise.
  [[nodiscard]] Result<ScanQuantity> remote_sensing_reflectance(const Light& light, const Direction& r) const;

  [[nodiscard]] const Interpolation& interpolation() const { return interpolation_; }
  [[nodiscard]] const MeasuredScan& scan() const { return scan_; }
  /// The part of the projected hemisphere of views that was not measured under i, 0 to 1.
  [[nodiscard]] double unmeasured_share(const Direction& i) const {
    return interpolation_.best().table().extrapolated_share(i);
  }

 private:
  ScanQuantities(MeasuredScan scan, Interpolation interpolation, std::optional<CapModel> cap);
  [[nodiscard]] ScanQuantity of(const char* name, const std::vector<PairNode>& fine,
                                const std::vector<PairNode>& coarse) const;
  [[nodiscard]] Result<void> check_incidence(const Direction& i) const;
  [[nodiscard]] Result<void> check_incidences() const;
  [[nodiscard]] Result<void> check_light(const std::vector<HemisphereNode>& nodes) const;

  MeasuredScan scan_;
  Interpolation interpolation_;
  std::optional<CapModel> cap_;
};

}  // namespace gonio::reflectance
