#include "bench/reflectance/rho_dh.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "bench/reflectance/ladder.h"
#include "bench/reflectance/quadrature.h"
#include "bench/reflectance/report.h"
#include "bench/reflectance/stopwatch.h"

namespace gonio::bench {
namespace {

constexpr double kTarget = 1e-6;
constexpr double kClaim = 100.0;
constexpr int kRounds = 7;

std::vector<Method> all_methods() {
  std::vector<Method> all;
  for (const auto& some : {our_methods(), grid_methods(), cubature_methods(), gsl_methods()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

using Results = std::map<std::string, Ladder>;  ///< by method, of one case

// Once through every setting for its error; then all in turns for their times.
Results measure(const Case& c, const std::vector<Method>& methods) {
  constexpr double kEnough = 1e-12;  // no finer grid is looked at
  constexpr double kTooLong = 1.0;   // s
  Results results;
  std::vector<Timed> timed;
  std::vector<std::pair<std::string, std::size_t>> owners;
  for (const Method& method : methods) {
    Ladder& ladder = results[method.name];
    for (Rung& rung : method.rungs(c)) {
      Estimate estimate;
      const double seconds = seconds_of([&] { estimate = rung.run(); });
      const double error = std::abs(estimate.value - c.rho_dh) / c.rho_dh;
      if (!std::isfinite(error)) break;
      owners.emplace_back(method.name, ladder.size());
      ladder.push_back({rung.setting, estimate.evaluations, error, 0.0});
      timed.push_back({[run = std::move(rung.run)] { (void)run(); }, seconds});
      if (seconds > kTooLong || (error < kEnough && method.family == Family::Grid)) break;
    }
  }
  const std::vector<double> medians = interleaved_medians(timed, kRounds);
  for (std::size_t n = 0; n < medians.size(); ++n) results[owners[n].first][owners[n].second].seconds = medians[n];
  return results;
}

const Step* asked_for_target(const Ladder& ladder) {
  const auto found = std::find_if(ladder.begin(), ladder.end(),
                                  [](const Step& step) { return step.setting == tolerance_text(kTarget); });
  return found == ladder.end() ? nullptr : &*found;
}

std::string ratio_text(double ratio) {
  if (!std::isfinite(ratio)) return "-";
  return text(ratio < 0.0995 ? "%.3f" : ratio < 0.995 ? "%.2f" : ratio < 9.95 ? "%.1f" : "%.0f", ratio);
}

// The tables of one run and the claim.
class Report {
 public:
  explicit Report(const std::vector<Method>& methods)
      : methods_(methods), times_(heads("rho_dh")), asked_(asked_heads()) {}

  void add(const Case& c, const Results& results) {
    add_times(c, results);
    add_asked(c, results);
  }

  [[nodiscard]] std::string markdown() const {
    std::string all = "Times to an error of 1e-6: of `rho_dh` itself, of the others as multiples of it.\n\n";
    all += times_.markdown() +
           "\nAsked for 1e-6: what comes back, and how much longer the others take when asked the same.\n\n";
    all += asked_.markdown() + "\n" + verdict();
    return all;
  }
  [[nodiscard]] bool holds() const { return short_of_.empty(); }

 private:
  [[nodiscard]] std::vector<std::string> heads(const char* ours) const {
    std::vector<std::string> all = {"surface", "theta_i", ours};
    for (const Method& m : methods_) {
      if (m.family == Family::Grid || m.family == Family::Adaptive) all.push_back(m.name);
    }
    return all;
  }
  [[nodiscard]] std::vector<std::string> asked_heads() const {
    std::vector<std::string> all = {"surface", "theta_i", "time", "evaluations", "error"};
    for (const Method& m : methods_) {
      if (m.family == Family::Adaptive) all.push_back(m.name);
    }
    return all;
  }

  void add_times(const Case& c, const Results& results) {
    const Step* ours = first_within(results.at("rho_dh"), kTarget);
    const double our_seconds = ours == nullptr ? std::numeric_limits<double>::quiet_NaN() : ours->seconds;
    std::vector<std::string> cells = {c.surface_name, text("%g", c.theta_i_deg), time_text(our_seconds)};
    double least = std::numeric_limits<double>::infinity();
    std::string nearest;
    for (const Method& m : methods_) {
      if (m.family != Family::Grid && m.family != Family::Adaptive) continue;
      const double ratio = interpolated_seconds(results.at(m.name), kTarget) / our_seconds;
      cells.push_back(ratio_text(ratio));
      if (m.family != Family::Adaptive || !(ratio < least)) continue;
      least = ratio;
      nearest = m.name;
    }
    times_.add(std::move(cells));
    ++cases_;
    if (ours == nullptr || least < kClaim) {
      short_of_.push_back(
          text("%s at %g deg: %.3g times (%s)", c.surface_name.c_str(), c.theta_i_deg, least, nearest.c_str()));
    }
  }

  void add_asked(const Case& c, const Results& results) {
    const Step* ours = asked_for_target(results.at("rho_dh"));
    if (ours == nullptr) return;
    std::vector<std::string> cells = {c.surface_name, text("%g", c.theta_i_deg), time_text(ours->seconds),
                                      std::to_string(ours->evaluations), text("%.0e", ours->error)};
    for (const Method& m : methods_) {
      if (m.family != Family::Adaptive) continue;
      const Step* theirs = asked_for_target(results.at(m.name));
      cells.push_back(theirs == nullptr ? "-" : ratio_text(theirs->seconds / ours->seconds));
    }
    asked_.add(std::move(cells));
  }

  [[nodiscard]] std::string verdict() const {
    std::string all =
        text("At 1e-6 `rho_dh` is at least %g times faster than every general quadrature in %zu of %zu cases", kClaim,
             cases_ - short_of_.size(), cases_);
    all += short_of_.empty() ? ".\n" : "; not in these:\n";
    for (const std::string& line : short_of_) all += "- " + line + "\n";
    return all;
  }

  const std::vector<Method>& methods_;
  Table times_;
  Table asked_;
  std::size_t cases_ = 0;
  std::vector<std::string> short_of_;
};

const char* family_name(Family family) {
  switch (family) {
    case Family::Ours:
      return "ours";
    case Family::OurPart:
      return "part";
    case Family::Grid:
      return "grid";
    case Family::Adaptive:
      break;
  }
  return "adaptive";
}

}  // namespace

bool measure_rho_dh(const std::filesystem::path& folder) {
  const std::vector<Method> methods = all_methods();
  std::ofstream tsv = file_in(folder, "rho_dh.tsv");
  tsv << "surface\ttheta_i_deg\tmethod\tfamily\tsetting\tevaluations\trelative_error\ttime_s\n";
  Report report(methods);
  for (const Case& c : rho_dh_cases()) {
    std::fprintf(stderr, "rho_dh: %s, %g deg\n", c.surface_name.c_str(), c.theta_i_deg);
    const Results results = measure(c, methods);
    for (const Method& m : methods) {
      for (const Step& s : results.at(m.name)) {
        tsv << c.surface_name << '\t' << c.theta_i_deg << '\t' << m.name << '\t' << family_name(m.family) << '\t'
            << s.setting << '\t' << s.evaluations << '\t' << text("%.3e\t%.4e\n", s.error, s.seconds);
      }
    }
    report.add(c, results);
  }
  file_in(folder, "rho_dh.md") << report.markdown();
  std::printf("%s\n", report.markdown().c_str());
  return report.holds();
}

}  // namespace gonio::bench
