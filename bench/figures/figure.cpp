#include "bench/figures/figure.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "reflectance/surface/make_surface.h"

namespace gonio::bench {
namespace {

using namespace gonio::reflectance;

constexpr int kThetaRows = 20;
constexpr int kPhiColumns = 48;

double value(const Figure& figure, const Curve& curve, const Direction& r) {
  const Direction i = Direction::from_angles(degrees(figure.theta_i_deg), Angle{});
  return in_per_steradian(curve.surface.eval(i, r)) * (curve.times_cosine ? r.mu() : 1.0);
}

LobePoint point(const Figure& figure, const Curve& curve, double theta_deg, double phi_deg) {
  const Direction r = Direction::from_angles(degrees(theta_deg), degrees(phi_deg));
  return {theta_deg, phi_deg, value(figure, curve, r)};
}

// A file of ours, or why it cannot be written.
Result<void> write(const std::filesystem::path& path, const std::string& content) {
  std::ofstream file(path);
  file << content;
  file.close();
  if (file) return {};
  return failure({.code = ErrorCode::StoreFailed, .tried = "write " + path.string(), .seen = "the disk refused"});
}

std::string line(const LobePoint& p) {
  const Vector d = Direction::from_angles(degrees(std::abs(p.theta_r_deg)), degrees(p.phi_r_deg)).vector();
  const double f = p.value_per_sr;
  return fmt::format("{:g} {:g} {:.6g} {:.5g} {:.5g} {:.5g}\n", p.theta_r_deg, p.phi_r_deg, f, f * d.x, f * d.y,
                     f * d.z);
}

std::string settings(const Figure& figure) {
  const std::size_t count = figure.curves.size();
  std::string all =
      fmt::format("name = '{}'\ntitle_text = '{}'\ntheta_i = {:g}\n", figure.name, figure.title, figure.theta_i_deg);
  all += fmt::format("array files[{0}]\narray legends[{0}]\n", count);
  for (std::size_t k = 0; k < count; ++k) {
    all += fmt::format("files[{0}] = '{1}'\nlegends[{0}] = '{2}'\n", k + 1, figure.curves[k].file,
                       figure.curves[k].legend);
  }
  return all;
}

Result<Curve> curve_of(std::string file, std::string legend, std::string_view model, const Parameters& parameters) {
  Result<Surface> surface = make_surface(model, parameters);
  if (!surface) return failure(std::move(surface).error());
  return Curve{std::move(file), std::move(legend), *std::move(surface)};
}

}  // namespace

Result<std::vector<Figure>> notes_figures() {
  const Parameters wind = {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}};
  Result<Curve> all[] = {
      curve_of("brdf", "f_r = {/Symbol r}/{/Symbol p}", "lambertian", {{"rho", 0.5}}),
      curve_of("intensity", "f_r cos {/Symbol q}_r, shape of the intensity", "lambertian", {{"rho", 0.5}}),
      curve_of("glint", "as in the notes, without shadowing", "cox_munk", wind),
      curve_of("smith", "with Smith''s shadowing", "cox_munk_smith", wind),
      curve_of("hapke", "H = (1 + 2{/Symbol m})/(1 + 2{/Symbol gm}), Hapke", "hapke", {{"omega0", 0.9}}),
      curve_of("printed", "H = (1 + {/Symbol m})/(1 + 2{/Symbol gm}), as printed", "hapke_as_printed",
               {{"omega0", 0.9}}),
      curve_of("wheat", "as a BRDF, eq 8", "rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}),
      curve_of("factor", "read as a reflectance factor: by {/Symbol p}", "rpv_brf",
               {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}})};
  for (Result<Curve>& curve : all) {
    if (!curve) return failure(std::move(curve).error());
  }
  all[1]->times_cosine = true;
  return std::vector<Figure>{
      {"notes-figure-3", "Figure 3: Lambertian surface, {/Symbol r} = 0.5", 30.0, 90.0, {*all[0], *all[1]}},
      {"notes-figure-4-glitter",
       "Figure 4, glitter alone: sea under 10 m/s of wind, n = 1.34",
       30.0,
       85.0,
       {*all[2], *all[3]}},
      {"notes-figure-6",
       "Figure 6: isotropic multiple scattering, {/Symbol w}_0 = 0.9",
       30.0,
       90.0,
       {*all[4], *all[5]}},
      {"notes-figure-8",
       "Figure 8: wheat canopy, {/Symbol r}_0 = 0.133, k = 0.851, g = -0.114",
       30.0,
       88.0,
       {*all[6], *all[7]}}};
}

std::vector<std::vector<LobePoint>> lobe(const Figure& figure, const Curve& curve) {
  std::vector<std::vector<LobePoint>> rows;
  for (int t = 0; t <= kThetaRows; ++t) {
    std::vector<LobePoint>& row = rows.emplace_back();
    const double theta_deg = figure.most_theta_r_deg * t / kThetaRows;
    for (int p = 0; p <= kPhiColumns; ++p) row.push_back(point(figure, curve, theta_deg, 360.0 * p / kPhiColumns));
  }
  return rows;
}

std::vector<LobePoint> cut(const Figure& figure, const Curve& curve) {
  constexpr double kStepDeg = 0.25;
  const int steps = static_cast<int>(std::lround(figure.most_theta_r_deg / kStepDeg));
  std::vector<LobePoint> points;
  for (int k = -steps; k <= steps; ++k) {
    LobePoint p = point(figure, curve, std::abs(k * kStepDeg), k < 0 ? 180.0 : 0.0);
    p.theta_r_deg = k * kStepDeg;
    points.push_back(p);
  }
  return points;
}

Result<void> write_figure(const Figure& figure, const std::filesystem::path& folder) {
  for (const Curve& curve : figure.curves) {
    std::string rows;
    for (const std::vector<LobePoint>& row : lobe(figure, curve)) {
      for (const LobePoint& p : row) rows += line(p);
      rows += "\n";
    }
    GONIO_TRY(write(folder / (figure.name + "-" + curve.file + "-lobe.dat"), rows));
    std::string points;
    for (const LobePoint& p : cut(figure, curve)) points += line(p);
    GONIO_TRY(write(folder / (figure.name + "-" + curve.file + "-cut.dat"), points));
  }
  return write(folder / (figure.name + ".gnuplot"), settings(figure));
}

}  // namespace gonio::bench
