#include "daemon/analysis/plot_deviations.h"

#include <cmath>
#include <set>

#include <fmt/format.h>

namespace gonio::analysis {
namespace {

constexpr std::size_t kMostMarked = 6;

// Blue below, red above, white between: Brewer's RdYlBu ends, readable in grey by its darkness.
constexpr const char* kTwoSided =
    "set palette defined (-1 '#313695', -0.5 '#74add1', 0 '#f7f7f7', 0.5 '#f46d43', 1 '#a50026')\n";

std::string deviations_table(const DeviationsView& view) {
  std::string table = "# theta_i_deg x_deg y_deg phase_deg deviation\n";
  for (const Deviation& d : view.points) {
    const double phi = (d.geometry.phi_r - d.geometry.phi_i).si();
    const double theta = in_degrees(d.geometry.theta_r);
    table += fmt::format("{:.5g} {:.5g} {:.5g} {:.5g} {:.5g}\n", in_degrees(d.geometry.theta_i), theta * std::cos(phi),
                         theta * std::sin(phi), in_degrees(phase_angle(d.geometry)), d.value);
  }
  return table;
}

// Squares towards the source, circles opposite, of the nominal incidences.
std::string marked_directions(const DeviationsView& view) {
  std::set<long> incidences;
  for (const Deviation& d : view.points) incidences.insert(std::lround(std::abs(in_degrees(d.geometry.theta_i))));
  if (incidences.size() > kMostMarked) return {};
  std::string objects;
  for (const long theta : incidences) {
    objects += fmt::format(
        "set label at {0},0 '' point pt 4 ps 1.4 lw 1.5 lc rgb '#d62728' front\n"
        "set label at -{0},0 '' point pt 6 ps 1.4 lw 1.5 lc rgb '#d62728' front\n",
        theta);
  }
  return objects;
}

}  // namespace

Picture deviations_picture(const DeviationsView& view) {
  Picture picture{.name = view.name, .caption = view.caption, .script = {}, .tables = {}};
  picture.width_px = 1200;
  picture.height_px = 480;
  const std::string name = fmt::format("{}-{}.dat", view.stem, view.name);
  picture.tables.emplace_back(name, deviations_table(view));
  const std::string bounds =
      view.is_in_u ? "set yrange [*<-3:3<*]; set for [s = -1:1:2] arrow from graph 0, first 2*s to graph 1, first 2*s "
                     "nohead dt 2 lc rgb '#d62728'\n"
                   : "";
  picture.script = fmt::format(
      "set multiplot layout 1,2 title {0} font ',15'\nset grid lc rgb '#dddddd'; unset key\n"
      "set xlabel 'phase angle ξ [°]'; set ylabel {1}\n{2}{3}"
      "plot {4} using 4:5 with points pt 7 ps 0.5 lc rgb '#31688e'\n"
      "unset arrow; set size ratio -1; set xrange [-92:92]; set yrange [-92:92]\n"
      "set xlabel 'θᵣ cos(φᵣ - φᵢ) [°], source at the right'; set ylabel 'θᵣ sin(φᵣ - φᵢ) [°]'\n"
      "set cblabel {1}; set cbrange [{5}]\n{6}"
      "plot {4} using 2:3 with points pt 7 ps 1.1 lc rgb '#888888', {4} using 2:3:5 with points pt 7 ps 0.9 lc "
      "palette\nunset multiplot\n",
      in_quotes(view.title), in_quotes(view.label), kTwoSided, bounds, in_quotes(name), view.is_in_u ? "-4:4" : "*:*",
      marked_directions(view));
  return picture;
}

}  // namespace gonio::analysis
