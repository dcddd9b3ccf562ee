#pragma once

// What a finished scan says of itself: its self-checks, and the budget of a point. Units stand in the names.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gonio::api {

/// How one self-check came out.
struct ScanCheckReport {
  std::string name;     ///< "closure", "reciprocity", "left-right", "energy", "repeats", "dark-history", "exposures"
  std::string verdict;  ///< "passed", "failed", "nothing to compare"
  std::int64_t compared = 0;  ///< of `unit`
  std::string unit;
  double chi_square = 0.0;
  double degrees_of_freedom = 0.0;
  double worst_z = 0.0;  ///< the largest deviation in its own standard uncertainty
  double p_value = 1.0;  ///< of as large a chi-square or deviation, if the scan is good
  std::vector<std::int64_t> worst_points;
  std::string finding;  ///< one sentence
};

struct ScanChecksReport {
  std::int64_t scan = 0;
  std::string summary;       ///< "failed: reciprocity", "passed: 5 of 7 had something to compare"
  double false_alarm = 0.0;  ///< the probability that a check of a good scan fails
  std::vector<ScanCheckReport> checks;
};

/// One line of a budget.
struct BudgetTermReport {
  std::string component;
  std::string kind;          ///< "random": drawn anew at each point; "shared": one error of many points
  std::string distribution;  ///< "normal", "rectangular", "arcsine"
  std::optional<double> u;   ///< standard uncertainty of the component; none: it differs from point to point
  std::string unit;
  std::optional<double> sensitivity;         ///< sr^-1 per unit of the component, signed for a shared one
  double contribution_per_sr = 0.0;          ///< sensitivity times u
  double share_percent = 0.0;                ///< of the combined variance
  std::optional<double> degrees_of_freedom;  ///< of u; none: as good as known
};

struct PointBudgetReport {
  std::int64_t scan = 0;
  std::int64_t point = 0;
  std::string chosen;  ///< why this point: "asked for", "the point of median U / |f|"
  double theta_i_deg = 0.0;
  double phi_i_deg = 0.0;
  double theta_r_deg = 0.0;
  double phi_r_deg = 0.0;
  double wavelength_nm = 0.0;
  double brdf_per_sr = 0.0;
  double u_random_per_sr = 0.0;
  double u_shared_per_sr = 0.0;
  double u_per_sr = 0.0;
  std::optional<double> degrees_of_freedom;  ///< effective; none: as good as infinite
  double k = 0.0;
  double expanded_u_per_sr = 0.0;
  double below_per_sr = 0.0;  ///< the 95.45 % interval reaches so far below the value, and above it
  double above_per_sr = 0.0;
  std::string method;
  std::string flags;
  std::vector<BudgetTermReport> terms;  ///< the largest share first
};

}  // namespace gonio::api
