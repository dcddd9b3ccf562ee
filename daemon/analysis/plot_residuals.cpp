#include "daemon/analysis/plot_residuals.h"

#include <cmath>

#include <fmt/format.h>

#include "base/geometry.h"

namespace gonio::analysis {

Picture residuals_picture(const std::string& stem, const fit::FitResult& fit) {
  Picture picture{.name = "residuals", .caption = {}, .script = {}, .tables = {}};
  picture.caption =
      "What the fit leaves of each reading, in units of its own random uncertainty: by phase angle, and over "
      "the directions of view; within 2 lie 95 % if model and uncertainties are true.";
  picture.width_px = 1200;
  picture.height_px = 480;
  std::string table = "# theta_i_deg x_deg y_deg phase_deg difference_per_sr z\n";
  for (const fit::FitResidual& r : fit.residuals) {
    const double phi = (r.geometry.phi_r - r.geometry.phi_i).si();
    const double theta = in_degrees(r.geometry.theta_r);
    table += fmt::format("{:.5g} {:.5g} {:.5g} {:.5g} {:.5g} {:.4g}\n", in_degrees(r.geometry.theta_i),
                         theta * std::cos(phi), theta * std::sin(phi), in_degrees(phase_angle(r.geometry)),
                         in_per_steradian(r.difference), r.z);
  }
  const std::string name = stem + "-residuals.dat";
  picture.tables.emplace_back(name, std::move(table));
  const std::string z = fit.has_even_weights ? "5" : "6";
  const std::string unit = fit.has_even_weights ? "reading - fit [sr⁻¹]" : "(reading - fit) / u of the reading";
  picture.script = fmt::format(
      "set multiplot layout 1,2 title {0} font ',15'\nset grid lc rgb '#dddddd'; unset key\n"
      "set xlabel 'phase angle ξ [°]'; set ylabel '{1}'\n"
      "set palette defined (-1 '#313695', -0.5 '#74add1', 0 '#f7f7f7', 0.5 '#f46d43', 1 '#a50026')\n"
      "{2}plot {3} using 4:{4} with points pt 7 ps 0.5 lc rgb '#31688e'\n"
      "unset arrow; set size ratio -1; set xrange [-92:92]; set yrange [-92:92]; set xlabel 'θᵣ cos(φᵣ - φᵢ) [°], "
      "source at the "
      "right'; set ylabel 'θᵣ sin(φᵣ - φᵢ) [°]'\nset cblabel '{1}'; {5}\n"
      "plot {3} using 2:3:{4} with points pt 7 ps 0.9 lc palette\nunset multiplot\n",
      in_quotes("What the fit of " + fit.model.name() + " leaves"), unit,
      fit.has_even_weights ? ""
                           : "set arrow from graph 0, first 2 to graph 1, first 2 nohead dt 2 lc rgb '#d62728'; set "
                             "arrow from graph 0, first -2 to graph 1, first -2 nohead dt 2 lc rgb '#d62728'\n",
      in_quotes(name), z, fit.has_even_weights ? "set cbrange [*:*]" : "set cbrange [-4:4]");
  return picture;
}

}  // namespace gonio::analysis
