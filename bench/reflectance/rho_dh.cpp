#include "bench/reflectance/rho_dh.h"

#include <cmath>
#include <cstdio>

#include "bench/reflectance/report.h"
#include "bench/reflectance/rho_dh_tables.h"
#include "bench/reflectance/stopwatch.h"

namespace gonio::bench {
namespace {

constexpr int kRounds = 5;

std::vector<Method> all_methods() {
  std::vector<Method> all;
  for (const auto& some : {our_methods(), grid_methods(), cubature_methods(), gsl_methods()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

// Once through every setting for its error; then all in turns for their times.
Ladders measure(const Case& c, const std::vector<Method>& methods) {
  constexpr double kEnough = 1e-12;  // no finer grid is looked at
  constexpr double kTooLong = 0.05;  // s
  Ladders ladders;
  std::vector<Timed> timed;
  std::vector<std::pair<std::string, std::size_t>> owners;
  for (const Method& method : methods) {
    Ladder& ladder = ladders[method.name];
    for (Rung& rung : method.rungs(c)) {
      Estimate estimate;
      const double seconds = seconds_of([&] { estimate = rung.run(1); });
      const double error = std::abs(estimate.value - c.rho_dh) / c.rho_dh;
      if (!std::isfinite(error)) break;
      owners.emplace_back(method.name, ladder.size());
      ladder.push_back({rung.setting, estimate.evaluations, error, 0.0});
      timed.push_back({[run = std::move(rung.run)](long repeats) { (void)run(repeats); }, seconds});
      if (seconds > kTooLong || (error < kEnough && method.family == Family::Grid)) break;
    }
  }
  const std::vector<double> medians = interleaved_medians(timed, kRounds);
  for (std::size_t n = 0; n < medians.size(); ++n) ladders[owners[n].first][owners[n].second].seconds = medians[n];
  return ladders;
}

const char* family_name(Family family) {
  switch (family) {
    case Family::Ours:
      return "ours";
    case Family::Prepared:
      return "prepared";
    case Family::OurPart:
      return "part";
    case Family::Grid:
      return "grid";
    case Family::Adaptive:
      break;
  }
  return "general";
}

void write(std::ofstream& tsv, const Case& c, const Method& m, const Ladder& ladder) {
  for (const Step& s : ladder) {
    tsv << c.surface_name << '\t' << c.theta_i_deg << '\t' << m.name << '\t' << family_name(m.family) << '\t'
        << s.setting << '\t' << s.evaluations << '\t' << text("%.3e\t%.4e\n", s.error, s.seconds);
  }
}

}  // namespace

bool measure_rho_dh(const std::filesystem::path& folder) {
  const std::vector<Method> methods = all_methods();
  std::ofstream tsv = file_in(folder, "rho_dh.tsv");
  tsv << "surface\ttheta_i_deg\tmethod\tfamily\tsetting\tevaluations\trelative_error\ttime_s\n";
  RhoDhTables tables(methods);
  for (const Case& c : rho_dh_cases()) {
    std::fprintf(stderr, "rho_dh: %s, %g deg\n", c.surface_name.c_str(), c.theta_i_deg);
    const Ladders ladders = measure(c, methods);
    for (const Method& m : methods) write(tsv, c, m, ladders.at(m.name));
    tables.add(c, ladders);
  }
  file_in(folder, "rho_dh.md") << tables.markdown();
  std::printf("%s\n", tables.markdown().c_str());
  return tables.claim_holds();
}

}  // namespace gonio::bench
