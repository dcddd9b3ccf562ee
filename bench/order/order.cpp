// How near the planner's order comes to the shortest walk: for products, lists, rings and cones of 100 to 100 000
// points the time of its steps (motion from rest to rest, settling) beside a lower bound that none of its code
// computes, the best boustrophedon and the order of the text. Ends with 1 when a walk of up to 1000 points takes more
// than 1.05 of the bound, or any more than the boustrophedon. Usage: bench_order [MOST_POINTS]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "bench/order/lower_bound.h"
#include "daemon/planner/chance.h"
#include "daemon/planner/estimate.h"
#include "daemon/planner/measuring_order.h"
#include "daemon/planner/planner.h"
#include "tests/daemon/support/bench_instrument.h"

namespace {

using namespace gonio;
using namespace gonio::daemon;

Geometry direction(double theta_i_deg, double theta_r_deg, double phi_r_deg) {
  return {.theta_i = degrees(theta_i_deg), .theta_r = degrees(theta_r_deg), .phi_r = degrees(phi_r_deg)};
}

std::vector<Geometry> product(int theta_i, int theta_r, int phi_r) {
  std::vector<Geometry> all;
  for (int i = 0; i < theta_i; ++i) {
    for (int j = 0; j < theta_r; ++j) {
      for (int k = 0; k < phi_r; ++k) {
        all.push_back(direction(10.0 + 60.0 * i / theta_i, 5.0 + 70.0 * j / theta_r, 20.0 + 300.0 * k / phi_r));
      }
    }
  }
  return all;
}

std::vector<Geometry> list(std::size_t count, std::uint64_t seed) {
  Chance chance(seed);
  const auto part = [&chance] { return static_cast<double>(chance.below(1'000'000)) * 1e-6; };
  std::vector<Geometry> all;
  while (all.size() < count) {
    const Geometry g = direction(std::round(8.0 * part()) * 10.0, 80.0 * std::sqrt(part()), 360.0 * part());
    if (!is_in_shadow(g, test::bench_instrument().shadow)) all.push_back(g);
  }
  return all;
}

std::vector<Geometry> rings(const std::vector<double>& theta_i_deg, int rings, int around) {
  std::vector<Geometry> all;
  for (const double theta_i : theta_i_deg) {
    for (int j = 0; j < rings; ++j) {
      // Spaced as Gauss nodes in cos^2 are, nearly: it is the order that is looked at here.
      const double u = std::cos((j + 0.75) / (rings + 0.5) * std::numbers::pi);
      const double theta_r = in_degrees(radians(std::acos(std::sqrt(0.1 + 0.9 * (0.5 + 0.5 * u)))));
      for (int k = 0; k < around; ++k) all.push_back(direction(theta_i, theta_r, (k + 0.5) * 360.0 / around));
    }
  }
  return all;
}

// About the specular direction: rings whose spacing grows with their distance from the peak.
std::vector<Geometry> cones(const std::vector<double>& theta_i_deg, double finest_deg, double half_angle_deg) {
  std::vector<Geometry> all;
  for (const double theta_i : theta_i_deg) {
    const double t = in_radians(degrees(theta_i));
    for (double alpha = finest_deg; alpha < half_angle_deg; alpha += finest_deg + 0.15 * alpha) {
      const double a = in_radians(degrees(alpha));
      const int around = std::max(6, static_cast<int>(std::sin(a) * 360.0 / (finest_deg + 0.15 * alpha) / 9.0));
      for (int k = 0; k < around; ++k) {
        const double b = 2.0 * std::numbers::pi * k / around;
        const double z = std::cos(t) * std::cos(a) - std::sin(t) * std::sin(a) * std::cos(b);
        const double x = -std::sin(t) * std::cos(a) - std::cos(t) * std::sin(a) * std::cos(b);
        const double theta_r = in_degrees(radians(std::acos(z)));
        if (theta_r > 80.0) continue;
        all.push_back(direction(theta_i, theta_r, in_degrees(radians(std::atan2(std::sin(a) * std::sin(b), x)))));
      }
    }
  }
  return all;
}

std::vector<ScanPoint> points_of(const std::vector<Geometry>& directions) {
  std::vector<ScanPoint> points;
  for (const Geometry& g : directions) {
    points.push_back({.index = static_cast<std::int32_t>(points.size()), .geometry = g, .wavelength = nanometres(568)});
  }
  return points;
}

// One pass from home, by the true prices.
double pass_s(const Instrument& instrument, const std::vector<ScanPoint>& points,
              const std::vector<std::int32_t>& order) {
  Place standing = home_position(instrument);
  standing[stage::index_of(stage::Axis::FilterWheel)] = instrument.filters.front().slot;
  double sum_s = 0.0;
  for (const std::int32_t index : order) {
    const ScanPoint& point = points[static_cast<std::size_t>(index)];
    const auto target = axis_targets(point.geometry, point.wavelength, instrument, standing);
    if (!target) std::abort();
    const auto step = step_time(instrument, standing, *target);
    if (!step) std::abort();
    sum_s += in_seconds(step->move + step->settle);
    for (std::size_t a = 0; a < standing.size(); ++a) standing[a] = (*target)[a].value_or(standing[a]);
  }
  return sum_s;
}

// The processor's, not the wall's: other work on the machine does not count.
double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

bool measure(const std::string& name, const std::vector<Geometry>& directions) {
  const Instrument instrument = test::bench_instrument();
  const std::vector<ScanPoint> points = points_of(directions);
  const api::Plan plan = test::bench_plan({30}, {0}, {0});
  api::Plan written = plan;
  written.order = api::OrderStrategy::AsWritten;
  const double began = cpu_seconds();
  const auto fastest = measuring_order(plan, instrument, points);
  const double took = cpu_seconds() - began;
  const auto as_written = measuring_order(written, instrument, points);
  if (!fastest || !as_written) std::abort();
  const double walk_s = pass_s(instrument, points, fastest->order);
  const std::vector<std::int32_t> snake = snaked_order(instrument, points);
  const auto snaked = estimate(plan, instrument, points, snake);
  if (!snaked) std::abort();
  const bench::WalkBound bound = bench::lower_bound(instrument.stage, directions);
  const double ratio = walk_s / bound.time_s;
  const bool within = (bound.places > 1000 || ratio <= 1.05) && fastest->time.total() <= snaked->total();
  std::printf("%-22s %7zu %10.1f %10.1f %-9s %6.3f %10.1f %10.1f %9.0f %9.0f %8.2f %s\n", name.c_str(), points.size(),
              walk_s, bound.time_s, bound.is_held_karp ? "Held-Karp" : "two near", ratio,
              pass_s(instrument, points, snake), pass_s(instrument, points, as_written->order),
              in_seconds(fastest->time.total()), in_seconds(snaked->total()), took, within ? "held" : "NOT HELD");
  std::fflush(stdout);
  return within;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t most = argc > 1 ? std::stoul(argv[1]) : 100'000;
  std::printf("%-22s %7s %10s %10s %-9s %6s %10s %10s %9s %9s %8s\n", "plan", "points", "walk [s]", "bound [s]", "by",
              "ratio", "snaked [s]", "text [s]", "scan [s]", "snaked", "CPU [s]");
  const std::vector<std::pair<std::string, std::function<std::vector<Geometry>()>>> plans{
      {"product 4 x 5 x 5", [] { return product(4, 5, 5); }},
      {"product 4 x 10 x 25", [] { return product(4, 10, 25); }},
      {"list of 200", [] { return list(200, 1); }},
      {"list of 1000", [] { return list(1000, 2); }},
      {"rings 3 x 12 x 24",
       [] {
         return rings({8, 30, 60}, 12, 24);
       }},
      {"cones of 3",
       [] {
         return cones({20, 40, 60}, 0.3, 30.0);
       }},
      {"list of 10 000", [] { return list(10'000, 3); }},
      {"rings 5 x 40 x 90",
       [] {
         return rings({5, 20, 35, 50, 65}, 40, 90);
       }},
      {"product 20 x 50 x 100", [] { return product(20, 50, 100); }},
      {"list of 100 000", [] { return list(100'000, 4); }},
  };
  bool all = true;
  for (const auto& [name, make] : plans) {
    const std::vector<Geometry> directions = make();
    if (directions.size() <= most) all = measure(name, directions) && all;
  }
  return all ? 0 : 1;
}
