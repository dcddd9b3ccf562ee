#include "bench/reflectance/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "bench/reflectance/cases.h"
#include "bench/reflectance/report.h"
#include "bench/reflectance/sampling_error.h"
#include "bench/reflectance/stopwatch.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/sampling/literal_sampler.h"
#include "reflectance/sampling/make_sampler.h"
#include "reflectance/sampling/random_stream.h"
#include "reflectance/sampling/table_sampler.h"

namespace gonio::bench {
namespace {

using namespace gonio::reflectance;

constexpr int kRounds = 9;
constexpr double kClaim = 2e7;  // directions/s
const RandomStream kStream(20261122);

/// One method on one surface, ready to be timed: `run` makes `count` directions.
struct Entry {
  std::string method;
  std::string setting;
  std::function<void()> run;
  std::size_t count = 0;
  DensityError error;
  double stated = std::nan("");  ///< total variation, where the method states one
  double made_s = 0.0;
  bool is_claim = false;
};

// Keeps a sum alive so that no draw can be left out.
void keep(double value) {
  asm volatile("" : : "g"(value) : "memory");
}

void add_literal(std::vector<Entry>& all, const Surface& s, const Direction& i, LiteralCells cells) {
  const auto sampler = std::make_shared<const LiteralSampler>(LiteralSampler::make(s, cells).value());
  const std::string setting = text("%dx%d cells", cells.theta, cells.phi);
  const DensityError error = literal_error(s, i, cells, rho_dh(s, i).value);
  const auto each = [sampler, i] {
    for (std::uint64_t k = 0; k < 16; ++k) keep(sampler->sample(i, kStream.point(k)).weight);
  };
  all.push_back({.method = "C1-C5, each photon anew", .setting = setting, .run = each, .count = 16, .error = error});
  const auto kept = [sampler, incidence = sampler->incidence(i)] {
    for (std::uint64_t k = 0; k < 1024; ++k) keep(sampler->sample(incidence, kStream.point(k)).weight);
  };
  all.push_back({.method = "C1-C5, incidence kept", .setting = setting, .run = kept, .count = 1024, .error = error});
}

Entry sampler_entry(std::string method, std::string setting, std::shared_ptr<const DirectionSampler> sampler) {
  constexpr std::size_t kBatch = 4096;
  static SampleArrays arrays(kBatch);
  const auto run = [sampler] {
    sampler->sample(kStream, 0, arrays.batch());
    keep(arrays.batch().weight[0]);
  };
  return {.method = std::move(method), .setting = std::move(setting), .run = run, .count = kBatch};
}

void add_table(std::vector<Entry>& all, const Surface& s, const Direction& i, TableUse use, double accuracy) {
  Result<std::unique_ptr<const TableSampler>> made = failure(Error{});
  const double made_s =
      seconds_of([&] { made = TableSampler::make(s, i, {.use = use, .accuracy = accuracy, .most_cells = 1 << 18}); });
  if (!made) return;  // the accuracy is not reached with that many cells
  const std::shared_ptr<const TableSampler> table = *std::move(made);
  const bool fast = use == TableUse::Fast;
  const std::string setting = text("%.0e: %zu cells", accuracy, table->report().cells);
  Entry entry = sampler_entry(fast ? "table, fast" : "table, unbiased", setting, table);
  const DensityError seen = table_error(s, i, *table, rho_dh(s, i).value);
  entry.error = fast ? seen : DensityError{.weight_sd = table->report().relative_rms};
  entry.stated = fast ? table->report().total_variation : 0.0;
  entry.made_s = made_s;
  entry.is_claim = fast && accuracy == SamplerOptions{}.accuracy;
  all.push_back(std::move(entry));
}

void add_best(std::vector<Entry>& all, const Surface& s, const Direction& i) {
  const std::shared_ptr<const DirectionSampler> sampler = make_sampler(s, i).value();
  if (sampler->report().method == SamplingMethod::Table) return;
  Entry entry = sampler_entry("make_sampler",
                              sampler->report().method == SamplingMethod::Closed ? "closed form" : "facets", sampler);
  entry.error.weight_sd = sampler->report().relative_rms;
  entry.stated = 0.0;
  all.push_back(std::move(entry));
}

void add_cosine(std::vector<Entry>& all, const Surface& s, const Direction& i) {
  const auto run = [s, i] {
    for (std::uint64_t k = 0; k < 1024; ++k) {
      const Direction r = power_cosine_direction(0.0, kStream.point(k));
      keep(std::numbers::pi * in_per_steradian(s.eval(i, r)));
    }
  };
  all.push_back(
      {.method = "cosine, weight pi f", .run = run, .count = 1024, .error = cosine_error(s, i, rho_dh(s, i).value)});
}

void add_rejection(std::vector<Entry>& all, const Surface& s, const Direction& i) {
  const double bound = greatest_brdf(s, i);
  const auto run = [s, i, bound] {
    std::uint64_t draw = 0;
    for (int k = 0; k < 1024; ++k) {
      for (;; draw += 2) {
        const Direction r = power_cosine_direction(0.0, kStream.point(draw));
        if (kStream.point(draw + 1).u * bound > in_per_steradian(s.eval(i, r))) continue;
        keep(r.mu());
        draw += 2;
        break;
      }
    }
  };
  all.push_back({.method = "rejection", .setting = text("bound %.3g/sr", bound), .run = run, .count = 1024});
}

std::vector<Entry> entries(const Surface& s, const Direction& i) {
  std::vector<Entry> all;
  add_literal(all, s, i, {.theta = 16, .phi = 32});
  add_literal(all, s, i, {.theta = 64, .phi = 128});
  for (const double accuracy : {3e-2, 1e-2, 2e-3, 5e-4, 1e-4}) add_table(all, s, i, TableUse::Fast, accuracy);
  add_table(all, s, i, TableUse::Unbiased, 1e-2);
  add_best(all, s, i);
  add_cosine(all, s, i);
  add_rejection(all, s, i);
  return all;
}

std::string share_text(double share) {
  return std::isnan(share) ? "" : share == 0.0 ? "0" : text("%.1e", share);
}

class Report {
 public:
  explicit Report(const std::filesystem::path& folder) : tsv_(file_in(folder, "sampling.tsv")) {
    tsv_ << "surface\tmethod\tsetting\tdirections_per_s\trho_error\tstated_misplaced\tmisplaced\tweight_sd\tmade_s\n";
  }
  void add(const std::string& surface, const Entry& e, double seconds) {
    const double rate = static_cast<double>(e.count) / seconds;
    tsv_ << surface << '\t' << e.method << '\t' << e.setting
         << text("\t%.3e\t%.2e\t%.2e\t%.2e\t%.2e\t%.2e\n", rate, e.error.rho, e.stated, e.error.misplaced,
                 e.error.weight_sd, e.made_s);
    table_.add({surface, e.method, e.setting, text("%.2g", rate), share_text(e.error.rho), share_text(e.stated),
                share_text(e.error.misplaced), share_text(e.error.weight_sd),
                e.made_s > 0.0 ? time_text(e.made_s) : ""});
    if (!e.is_claim) return;
    const bool holds = rate >= kClaim && e.error.misplaced <= 1.05 * e.stated + 1e-5;
    holds_ = holds_ && holds;
    claims_ += text("- %s: %.2g directions/s, misplacing at most %.1e of them as stated (%.1e seen): %s\n",
                    surface.c_str(), rate, e.stated, e.error.misplaced, holds ? "held" : "NOT HELD");
  }
  [[nodiscard]] std::string markdown() const {
    return "The claim, 2e7 directions/s on one core, for the fast table at its default accuracy:\n" + claims_ + "\n" +
           table_.markdown();
  }
  [[nodiscard]] bool holds() const { return holds_; }

 private:
  std::ofstream tsv_;
  Table table_{{"surface", "method", "setting", "directions/s", "error of rho", "stated: misplaced", "seen: misplaced",
                "sd of weights", "made in"}};
  std::string claims_;
  bool holds_ = true;
};

}  // namespace

bool measure_sampling(const std::filesystem::path& folder) {
  const Parameters wind = {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}};
  const std::vector<std::pair<std::string, Surface>> surfaces = {
      {"rpv wheat", surface_of("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}})},
      {"minnaert k=.5", surface_of("minnaert", {{"rho", 0.5}, {"k", 0.5}})},
      {"hapke_hg .9 g=-.3", surface_of("hapke_hg", {{"omega0", 0.9}, {"g", -0.3}})},
      {"glint_smith W=10", surface_of("cox_munk_smith", wind)},
      {"glint, variance .001", surface_of("glint", {{"slope_variance", 1e-3}, {"refractive_index", 1.34}})}};
  const Direction i = Direction::from_angles(degrees(30.0), Angle{});
  Report report(folder);
  for (const auto& [name, s] : surfaces) {
    std::fprintf(stderr, "sampling: %s\n", name.c_str());
    const std::vector<Entry> all = entries(s, i);
    std::vector<Timed> timed;
    for (const Entry& e : all) {
      const auto many = [&e](long repeats) {
        for (long k = 0; k < repeats; ++k) e.run();
      };
      timed.push_back({many, seconds_of(e.run)});
    }
    const std::vector<double> medians = interleaved_medians(timed, kRounds);
    for (std::size_t n = 0; n < all.size(); ++n) report.add(name, all[n], medians[n]);
  }
  file_in(folder, "sampling.md") << report.markdown();
  std::printf("%s\n", report.markdown().c_str());
  return report.holds();
}

}  // namespace gonio::bench
