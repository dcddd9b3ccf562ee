#include "bench/reflectance/evaluation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "bench/reflectance/cases.h"
#include "bench/reflectance/report.h"
#include "bench/reflectance/stopwatch.h"
#include "reflectance/sampling/random_stream.h"

namespace gonio::bench {
namespace {

using namespace gonio::reflectance;

constexpr std::size_t kBatch = 4096;
constexpr int kRounds = 15;

std::vector<std::pair<std::string, Surface>> surfaces() {
  const Parameters wind = {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}};
  return {{"lambertian", surface_of("lambertian", {{"rho", 0.5}})},
          {"minnaert k=.5", surface_of("minnaert", {{"rho", 0.5}, {"k", 0.5}})},
          {"hapke .9", surface_of("hapke", {{"omega0", 0.9}})},
          {"hapke_exact .9", surface_of("hapke_exact", {{"omega0", 0.9}})},
          {"hapke_hg .9 g=-.3", surface_of("hapke_hg", {{"omega0", 0.9}, {"g", -0.3}})},
          {"rpv wheat", surface_of("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}})},
          {"water_body .02", surface_of("water_body", {{"rho_w", 0.02}, {"refractive_index", 1.34}})},
          {"glint W=10", surface_of("cox_munk", wind)},
          {"glint_smith W=10", surface_of("cox_munk_smith", wind)},
          {"glint, variance .001", surface_of("glint", {{"slope_variance", 1e-3}, {"refractive_index", 1.34}})}};
}

// By the cosine law, as most uses have them.
std::vector<Direction> directions(std::size_t count, std::uint64_t seed) {
  std::vector<Direction> all;
  for (std::size_t k = 0; k < count; ++k) all.push_back(power_cosine_direction(0.0, RandomStream(seed).point(k)));
  return all;
}

struct Times {
  double scalar = 0.0;  ///< s a value, as are the others
  double batch = 0.0;
  double fast = 0.0;
  double block = 0.0;
};

template <class F>
Timed timed(F run) {
  const auto many = [run](long repeats) {
    for (long k = 0; k < repeats; ++k) {
      run();
      asm volatile("" : : : "memory");
    }
  };
  return {many, 1e-4};
}

Times measure(const Surface& s) {
  const Direction i = Direction::from_angles(degrees(30.0), Angle{});
  const std::vector<Direction> r = directions(kBatch, 1);
  std::vector<DirectionBlock> blocks(kBatch / DirectionBlock::kSize);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    blocks[b].assign(std::span(r).subspan(b * DirectionBlock::kSize, DirectionBlock::kSize));
  }
  std::vector<Brdf> f(kBatch);
  BrdfBlock block_f;
  const std::vector<double> medians =
      interleaved_medians({timed([&] {
                             for (std::size_t k = 0; k < kBatch; ++k) f[k] = s.eval(i, r[k]);
                           }),
                           timed([&] { s.eval(i, r, f); }), timed([&] { s.eval_fast(i, r, f); }), timed([&] {
                             for (const DirectionBlock& b : blocks) s.eval_fast(i, b, block_f);
                           })},
                          kRounds);
  return {medians[0] / kBatch, medians[1] / kBatch, medians[2] / kBatch, medians[3] / kBatch};
}

struct FastError {
  double relative = 0.0;        ///< greatest |fast - exact| / exact, of values above the stated absolute error
  double share_of_bound = 0.0;  ///< greatest |fast - exact| / stated; at most 1 where the promise holds
};

FastError fast_error(const Surface& s) {
  const FastPath path = s.fast_path();
  const std::vector<Direction> r = directions(65536, 2);
  std::vector<Brdf> exact(r.size());
  std::vector<Brdf> fast(r.size());
  FastError greatest;
  for (const double theta_i_deg : {0.0, 30.0, 60.0, 85.0, 89.5}) {
    const Direction i = Direction::from_angles(degrees(theta_i_deg), Angle{});
    s.eval(i, r, exact);
    s.eval_fast(i, r, fast);
    for (std::size_t k = 0; k < r.size(); ++k) {
      const double value = std::abs(exact[k].si());
      const double off = std::abs(fast[k].si() - exact[k].si());
      if (off == 0.0) continue;
      const double stated = path.relative_error * value + path.absolute_error.si();
      // Where the stated absolute part counts most, a ratio to the value says nothing.
      if (path.absolute_error.si() < path.relative_error * value)
        greatest.relative = std::max(greatest.relative, off / value);
      greatest.share_of_bound = std::max(greatest.share_of_bound, off / stated);
    }
  }
  return greatest;
}

std::string nanoseconds(double seconds) {
  return text("%.1f ns", 1e9 * seconds);
}

}  // namespace

bool measure_evaluation(const std::filesystem::path& folder) {
  Table table(
      {"surface", "one by one", "batch", "fast batch", "fast block of 64", "gain", "stated relative error", "seen"});
  std::ofstream tsv = file_in(folder, "evaluation.tsv");
  tsv << "surface\tscalar_s\tbatch_s\tfast_s\tfast_block_s\tstated_relative_error\tstated_absolute_error_per_sr\t"
         "seen_relative_error\tshare_of_bound\n";
  bool holds = true;
  for (const auto& [name, s] : surfaces()) {
    std::fprintf(stderr, "evaluation: %s\n", name.c_str());
    const Times t = measure(s);
    const FastPath path = s.fast_path();
    const FastError error = fast_error(s);
    holds = holds && error.share_of_bound <= 1.0;
    tsv << name << text("\t%.3e\t%.3e\t%.3e\t%.3e", t.scalar, t.batch, t.fast, t.block)
        << text("\t%.2e\t%.2e\t%.2e\t%.2f\n", path.relative_error, path.absolute_error.si(), error.relative,
                error.share_of_bound);
    table.add({name, nanoseconds(t.scalar), nanoseconds(t.batch), nanoseconds(t.fast), nanoseconds(t.block),
               text("%.1f", t.scalar / t.block), path.has_kernel ? text("%.1e", path.relative_error) : "exact",
               error.relative == 0.0 ? "0" : text("%.1e", error.relative)});
  }
  file_in(folder, "evaluation.md") << table.markdown();
  std::printf("%s\n", table.markdown().c_str());
  return holds;
}

}  // namespace gonio::bench
