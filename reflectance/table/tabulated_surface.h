#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "reflectance/integral/integral.h"
#include "reflectance/surface/surface.h"
#include "reflectance/table/incidence_index.h"
#include "reflectance/table/table_options.h"
#include "reflectance/table/table_reading.h"
#include "reflectance/table/table_report.h"
#include "reflectance/table/table_row.h"

namespace gonio::reflectance {

/// A measured surface: the BRDF between readings, and what it is worth there. At a reading eval gives that reading
/// (unless `reciprocal` mixes it with its partner's). Between the views of an incidence it is linear, so that it stays
/// within its readings' range, signs included; between incidences it is linear too, in coordinates that move with the
/// feature (feature_motion.h). Where nothing was measured `covers` says so. An isotropic surface without readings at
/// theta_i = 0 is taken there as what a turn leaves of its first incidence. The incidences of an anisotropic one, below
/// its first theta_i, keep to their phi_i, and so meet in a jump at the normal.
///
/// `parameters` counts the readings; no table of `make_surface` knows this model, as it has no numbers but its data.
/// Copies share the immutable data. Threads: any.
class TabulatedSurface {
 public:
  /// What is known at a pair of directions.
  struct Known {
    double f = 0.0;  ///< [sr^-1]
    double u = 0.0;  ///< [sr^-1]
    bool is_covered = false;
    double distance = 0.0;  ///< from the readings, weighted as they are [rad]
  };

  /// Errors: InvalidInput, naming the reading's index (from 0) and field, or the option: no readings, fewer than two
  /// directions, a theta outside of [0, 90 deg], an azimuth, value or uncertainty that is not finite, a negative
  /// uncertainty, scattered directions of an incidence on one line (declare rings), more than 4096 incidences, an
  /// option out of its range. 7e3 scattered readings take some 20 ms.
  [[nodiscard]] static Result<TabulatedSurface> make(std::span<const TableReading> readings,
                                                     const TableOptions& options);

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(options_.reciprocal ? both_ways(i, r).f : one_way(i, r));
  }
  /// The value with its standard uncertainty, which is the readings' interpolated with the same weights: no less than
  /// the truth whatever correlates them, and without the error of the interpolation (cross_validation.h tells that).
  [[nodiscard]] Measured<Brdf> measured(const Direction& i, const Direction& r) const;
  /// Whether readings surround the pair closely enough by the options: else the value is a continuation.
  [[nodiscard]] bool covers(const Direction& i, const Direction& r) const;
  /// What part of the projected hemisphere of views is not covered under i, 0 to 1, to about 0.004: the part of the
  /// weight in rho_dh(i) that was not measured.
  [[nodiscard]] double extrapolated_share(const Direction& i) const;

  /// By Gauss nodes within the cells of the readings: a general quadrature meets a kink everywhere and takes agreement
  /// by chance for convergence. Orders are raised until two agree to `relative_tolerance`. `error` is the quadrature's
  /// alone: what the interpolation and the part beyond the reach are worth, `cross_validate` and `extrapolated_share`
  /// tell. A reciprocal table, and readings that do not surround the normal, have no such cells and go by rings (some
  /// 2e5 evaluations for 1e-4).
  [[nodiscard]] Integral rho_dh(const Direction& i, double relative_tolerance) const;

  [[nodiscard]] std::string_view model() const { return "tabulated"; }
  [[nodiscard]] Parameters parameters() const;
  [[nodiscard]] bool is_isotropic() const { return options_.symmetry == TableSymmetry::Isotropic; }
  [[nodiscard]] Feature feature() const { return feature_; }

  [[nodiscard]] const TableOptions& options() const { return options_; }
  [[nodiscard]] const TableReport& report() const { return *report_; }
  /// The incidences, as measured.
  [[nodiscard]] std::span<const TableRow> rows() const { return *rows_; }
  /// Without reciprocal mixing: what the readings under i say, never those under r.
  [[nodiscard]] Known known_one_way(const Direction& i, const Direction& r) const;
  /// What part of the value at (i, r) each reading is: the weights of known_one_way, which sum to 1, in no order and a
  /// reading perhaps more than once. False where `covers` is, without reciprocal mixing. Not for BeyondReach::Continue,
  /// which is not linear in the readings (asserted).
  [[nodiscard]] bool shares(const Direction& i, const Direction& r, std::vector<ReadingShare>& shares) const;
  /// Takes a row that a value is made of, where its view lies in that row, and the row's weight.
  using RowVisitor = std::function<void(const TableRow& row, const Stencil& stencil, double weight)>;
  /// All that known_one_way(i, r) is made of; the weights sum to 1, a row comes once for each feature that moves.
  void visit_rows(const Direction& i, const Direction& r, const RowVisitor& visit) const;
  /// What the other incidences make of a view of this one, which is one of `rows()`; `view` in the row's frame. Nothing
  /// where they do not lie around it, as with the outermost, or farther apart than declared.
  [[nodiscard]] std::optional<double> told_by_other_incidences(const TableRow& own, const Vector& view) const;
  [[nodiscard]] IncidenceBracket bracket(const Direction& i) const { return index_.bracket(i); }
  /// The row of a share of a bracket; one is made for the normal where it was not measured.
  [[nodiscard]] const TableRow& row(std::size_t k) const { return k < rows_->size() ? (*rows_)[k] : *normal_row_; }

  /// The same surface without one of its incidences: what cross-validation asks. There must be two or more.
  [[nodiscard]] TabulatedSurface without_incidence(std::size_t k) const;

 private:
  TabulatedSurface(std::vector<TableRow> rows, const TableOptions& options, TableReport report);
  [[nodiscard]] double one_way(const Direction& i, const Direction& r) const;
  [[nodiscard]] Known both_ways(const Direction& i, const Direction& r) const;
  [[nodiscard]] Vector in_frame(const Direction& i, const Direction& r) const;
  template <class Use>
  void at_places(const IncidenceBracket& bracket, const Direction& i, const Vector& seen, Use use) const;

  TableOptions options_;
  Feature feature_;
  std::shared_ptr<const std::vector<TableRow>> rows_;
  std::shared_ptr<const TableRow> normal_row_;
  std::shared_ptr<const TableReport> report_;
  IncidenceIndex index_;
};

}  // namespace gonio::reflectance
