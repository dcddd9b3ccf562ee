#include "bench/reflectance/rho_dh_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gonio::bench {
namespace {

constexpr double kTarget = 1e-6;
constexpr double kClaim = 100.0;
constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

const Step* asked_for_target(const Ladder& ladder) {
  const auto found =
      std::find_if(ladder.begin(), ladder.end(), [](const Step& s) { return s.setting == tolerance_text(kTarget); });
  return found == ladder.end() ? nullptr : &*found;
}

std::string ratio_text(double ratio) {
  if (!std::isfinite(ratio)) return "-";
  return text(ratio < 0.095 ? "%.2f" : ratio < 9.95 ? "%.1f" : "%.0f", ratio);
}

// Ours count by the first setting that is good enough, without interpolation.
double our_seconds(const Ladder& ladder) {
  const Step* step = first_within(ladder, kTarget);
  return step == nullptr ? kNever : step->seconds;
}

std::vector<std::string> heads(const std::vector<Method>& methods, std::vector<std::string> first, bool with_grids) {
  for (const Method& m : methods) {
    if (m.family == Family::Adaptive || (with_grids && m.family == Family::Grid)) first.push_back(m.name);
  }
  first.insert(first.end(), {"prepared is faster by", "`rho_dh` is faster by"});
  return first;
}

double smaller(double least, double seconds) {
  return std::isfinite(seconds) ? std::min(least, seconds) : least;
}

}  // namespace

RhoDhTables::RhoDhTables(const std::vector<Method>& methods)
    : methods_(methods),
      reached_(heads(methods, {"surface", "theta_i", "prepared", "`rho_dh`"}, true)),
      asked_(heads(methods, {"surface", "theta_i", "prepared", "its error", "`rho_dh`", "its error", "evaluations"},
                   false)),
      made_({"surface", "made in", "evaluations", "pieces", "read in", "hcubature", "pays after"}) {}

void RhoDhTables::Claim::add(const Case& c, double ratio) {
  ++cases;
  if (ratio >= kClaim) return;
  short_of.push_back(text("%s at %g deg (%s)", c.surface_name.c_str(), c.theta_i_deg, ratio_text(ratio).c_str()));
}

std::string RhoDhTables::Claim::sentence(const char* what) const {
  std::string all =
      text("- %s: at least %g times faster in %zu of %zu cases", what, kClaim, cases - short_of.size(), cases);
  constexpr std::size_t kMostNamed = 10;  // beyond that the last column of the table is easier to read
  if (short_of.size() > kMostNamed) return all + " (each in the table below).\n";
  for (std::size_t k = 0; k < short_of.size(); ++k) all += (k == 0 ? ", not for " : ", ") + short_of[k];
  return all + ".\n";
}

void RhoDhTables::add(const Case& c, const Ladders& ladders) {
  add_reached(c, ladders);
  add_asked(c, ladders);
  add_prepared(c, ladders);
}

void RhoDhTables::add_reached(const Case& c, const Ladders& ladders) {
  const double read = our_seconds(ladders.at("prepared"));
  const double direct = our_seconds(ladders.at("rho_dh"));
  std::vector<std::string> cells = {c.surface_name, text("%g", c.theta_i_deg), time_text(read), time_text(direct)};
  double least = std::numeric_limits<double>::infinity();
  for (const Method& m : methods_) {
    if (m.family != Family::Grid && m.family != Family::Adaptive) continue;
    const double seconds = interpolated_seconds(ladders.at(m.name), kTarget);
    cells.push_back(time_text(seconds));
    if (m.family == Family::Adaptive) least = smaller(least, seconds);
  }
  cells.push_back(ratio_text(least / read));
  cells.push_back(ratio_text(least / direct));
  reached_.add(std::move(cells));
  prepared_.add(c, least / read);
  direct_.add(c, least / direct);
}

void RhoDhTables::add_asked(const Case& c, const Ladders& ladders) {
  const Step* read = asked_for_target(ladders.at("prepared"));
  const Step* direct = asked_for_target(ladders.at("rho_dh"));
  if (read == nullptr || direct == nullptr) return;
  std::vector<std::string> cells = {c.surface_name,
                                    text("%g", c.theta_i_deg),
                                    time_text(read->seconds),
                                    text("%.0e", read->error),
                                    time_text(direct->seconds),
                                    text("%.0e", direct->error),
                                    std::to_string(direct->evaluations)};
  double least = std::numeric_limits<double>::infinity();
  for (const Method& m : methods_) {
    if (m.family != Family::Adaptive) continue;
    const Step* theirs = asked_for_target(ladders.at(m.name));
    const bool right = theirs != nullptr && theirs->error <= kTarget;
    cells.push_back(theirs == nullptr ? "-"
                                      : time_text(theirs->seconds) + (right ? "" : text(" (%.0e)", theirs->error)));
    if (right) least = smaller(least, theirs->seconds);
  }
  cells.push_back(ratio_text(least / read->seconds));
  cells.push_back(ratio_text(least / direct->seconds));
  asked_.add(std::move(cells));
  prepared_asked_.add(c, least / read->seconds);
  direct_asked_.add(c, least / direct->seconds);
}

void RhoDhTables::add_prepared(const Case& c, const Ladders& ladders) {
  const Step* read = asked_for_target(ladders.at("prepared"));
  const Step* general = asked_for_target(ladders.at("hcubature (theta, phi)"));
  if (c.surface_name == last_made_ || c.theta_i_deg == 0.0 || read == nullptr || general == nullptr) return;
  last_made_ = c.surface_name;
  const Prepared& made = prepared(c, kTarget);
  made_.add({c.surface_name, time_text(made.seconds), std::to_string(made.reflectance.evaluations()),
             std::to_string(made.reflectance.pieces()), time_text(read->seconds), time_text(general->seconds),
             text("%.0f readings", std::ceil(made.seconds / (general->seconds - read->seconds)))});
}

std::string RhoDhTables::markdown() const {
  std::string all = "Beside the fastest general quadrature of each case (factors in brackets):\n\n";
  all += prepared_.sentence("**prepared rho_dh, to an error of 1e-6**");
  all += prepared_asked_.sentence("**prepared rho_dh, both asked for 1e-6**");
  all += direct_.sentence("a single `rho_dh`, to an error of 1e-6");
  all += direct_asked_.sentence("a single `rho_dh`, both asked for 1e-6");
  all +=
      "\n### Time to an error of 1e-6\nOurs by the first setting that is good enough, the others by interpolation. A "
      "dash: not reached.\n\n";
  all += reached_.markdown();
  all +=
      "\n### Time when asked for 1e-6\nWhat a caller meets who does not know the truth. In brackets: the error of "
      "those that missed what "
      "they were asked for; the factors are against the fastest of the others.\n\n";
  all += asked_.markdown();
  all +=
      "\n### What it costs to prepare a surface to 1e-6\nBeside hcubature (theta, phi), asked for the same at the "
      "first oblique incidence.\n\n";
  return all + made_.markdown();
}

}  // namespace gonio::bench
