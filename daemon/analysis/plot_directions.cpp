#include "daemon/analysis/plot_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "reflectance/table/tabulated_surface.h"

namespace gonio::analysis {
namespace {

using formats::BrdfPoint;
using reflectance::Direction;

constexpr double kRadiansADegree = std::numbers::pi / 180.0;
constexpr double kWideRange = 40.0;  // beyond it a linear scale shows one spot and nothing else
constexpr std::size_t kPanels = 6;
constexpr double kThetaStepDeg = 2.5;
constexpr double kPhiStepDeg = 5.0;

// matplotlib's viridis (Smith and van der Walt 2015): even steps are seen as even.
constexpr const char* kPalette =
    "set palette defined (0 '#440154', 1 '#482878', 2 '#3e4a89', 3 '#31688e', 4 '#26828e', 5 '#1f9e89', 6 '#35b779', "
    "7 '#6dcd59', 8 '#b4de2c', 9 '#fde725')\n";

double azimuth_from_source(const BrdfPoint& p) {
  return std::remainder(p.phi_r_deg - p.phi_i_deg, 360.0);
}

// How the values of a channel are best shown.
struct Scale {
  double least = 0.0;  ///< shown
  double most = 1.0;
  bool is_log = false;
};

Scale scale_of(const ChannelView& view) {
  std::vector<double> values;
  for (const BrdfPoint& p : view.points) values.push_back(p.f_per_sr);
  std::ranges::sort(values);
  Scale scale;
  scale.most = values.back() > 0.0 ? values.back() : 1.0;
  const double middle = values[values.size() / 2];
  scale.is_log = middle > 0.0 && scale.most > kWideRange * middle;
  scale.least = scale.is_log ? std::max(values.front(), 1e-4 * scale.most) : std::min(0.0, values.front());
  return scale;
}

// NaN where nothing was measured.
double shown_value(const ChannelView& view, const Direction& i, const Direction& r) {
  if (view.surface == nullptr) return std::nan("");
  const auto* table = view.surface->as<reflectance::TabulatedSurface>();
  if (table != nullptr && !table->covers(i, r)) return std::nan("");
  return in_per_steradian(view.surface->eval(i, r));
}

// Blocks of theta_r, rows of phi_r - phi_i: x y [deg], f, and the lobe's x y z.
std::string hemisphere_table(const ChannelView& view, const IncidenceGroup& group, const Scale& scale) {
  std::string text = "# x_deg y_deg f_per_sr lobe_x lobe_y lobe_z\n";
  const Direction i = Direction::from_angles(degrees(group.theta_i_deg), degrees(group.phi_i_deg));
  for (double theta = 0.0; theta < 90.0; theta += kThetaStepDeg) {
    for (double phi = 0.0; phi < 360.0 + 0.5 * kPhiStepDeg; phi += kPhiStepDeg) {
      const Direction r = Direction::from_angles(degrees(theta), degrees(phi + group.phi_i_deg));
      const double f = shown_value(view, i, r);
      const double radius = scale.is_log ? std::cbrt(std::max(f, 0.0)) : std::max(f, 0.0);
      const double s = std::sin(theta * kRadiansADegree);
      const double cos_phi = std::cos(phi * kRadiansADegree);
      const double sin_phi = std::sin(phi * kRadiansADegree);
      text += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g}\n", theta * cos_phi, theta * sin_phi,
                          std::isnan(f) ? f : std::max(f, scale.is_log ? scale.least : f), radius * s * cos_phi,
                          radius * s * sin_phi, radius * std::cos(theta * kRadiansADegree));
    }
    text += '\n';
  }
  return text;
}

std::string readings_table(const IncidenceGroup& group) {
  std::string text = "# x_deg y_deg f_per_sr U_per_sr theta_in_plane_deg is_in_plane\n";
  for (const BrdfPoint& p : group.points) {
    const double phi = azimuth_from_source(p) * kRadiansADegree;
    const double aside = std::sin(p.theta_r_deg * kRadiansADegree) * std::abs(std::sin(phi));
    const bool in_plane = aside < std::sin(2.0 * kRadiansADegree);
    const double signed_theta = std::cos(phi) < 0.0 ? -p.theta_r_deg : p.theta_r_deg;
    text += fmt::format("{:.6g} {:.6g} {:.8g} {:.4g} {:.6g} {}\n", p.theta_r_deg * std::cos(phi),
                        p.theta_r_deg * std::sin(phi), p.f_per_sr, p.U_per_sr, signed_theta, in_plane ? 1 : 0);
  }
  return text;
}

std::string plane_table(const ChannelView& view, const IncidenceGroup& group) {
  std::string text = "# theta_in_plane_deg f_per_sr\n";
  const Direction i = Direction::from_angles(degrees(group.theta_i_deg), degrees(group.phi_i_deg));
  for (double theta = -89.5; theta < 90.0; theta += 0.5) {
    const Direction r =
        Direction::from_angles(degrees(std::abs(theta)), degrees(group.phi_i_deg + (theta < 0.0 ? 180.0 : 0.0)));
    text += fmt::format("{:.6g} {:.8g}\n", theta, shown_value(view, i, r));
  }
  return text;
}

struct Layout {
  std::size_t rows = 1;
  std::size_t columns = 1;
};

Layout layout_of(std::size_t panels) {
  constexpr std::size_t kMostColumns = 3;
  const std::size_t columns = std::min(panels, kMostColumns);
  return {.rows = (panels + columns - 1) / columns, .columns = columns};
}

// A picture of panels, one an incidence, with their tables.
Picture begin_picture(const ChannelView& view, const std::string& name, const std::string& title, std::size_t panels,
                      int width, int height) {
  const Layout layout = layout_of(panels);
  Picture picture{.name = name + view.tail, .caption = {}, .script = {}, .tables = {}};
  picture.width_px = width * static_cast<int>(layout.columns) + 40;
  picture.height_px = height * static_cast<int>(layout.rows) + 60;
  picture.script = fmt::format("set multiplot layout {},{} title {} font ',15'\n", layout.rows, layout.columns,
                               in_quotes(title + ": " + view.title));
  return picture;
}

std::string table_name(const ChannelView& view, const std::string& kind, std::size_t panel) {
  return fmt::format("{}-{}{}-{}.dat", view.stem, kind, view.tail, panel + 1);
}

}  // namespace

std::vector<IncidenceGroup> incidence_groups(const std::vector<BrdfPoint>& points, std::size_t most) {
  constexpr double kOneIncidenceDeg = 0.5;
  std::vector<IncidenceGroup> groups;
  for (const BrdfPoint& p : points) {
    const auto same = std::ranges::find_if(groups, [&](const IncidenceGroup& g) {
      const double turned = std::abs(std::remainder(g.phi_i_deg - p.phi_i_deg, 360.0));
      return std::abs(g.theta_i_deg - p.theta_i_deg) < kOneIncidenceDeg &&
             (turned < kOneIncidenceDeg || p.theta_i_deg < kOneIncidenceDeg);
    });
    if (same != groups.end()) {
      same->points.push_back(p);
    } else {
      groups.push_back({.theta_i_deg = p.theta_i_deg, .phi_i_deg = p.phi_i_deg, .points = {p}});
    }
  }
  std::ranges::sort(groups, [](const IncidenceGroup& a, const IncidenceGroup& b) {
    return std::pair(a.phi_i_deg, a.theta_i_deg) < std::pair(b.phi_i_deg, b.theta_i_deg);
  });
  if (groups.size() <= most) return groups;
  std::vector<IncidenceGroup> shown;
  for (std::size_t n = 0; n < most; ++n) shown.push_back(std::move(groups[n * (groups.size() - 1) / (most - 1)]));
  return shown;
}

Picture polar_picture(const ChannelView& view) {
  const std::vector<IncidenceGroup> groups = incidence_groups(view.points, kPanels);
  const Scale scale = scale_of(view);
  Picture picture = begin_picture(view, "polar", "f_r seen along the normal", groups.size(), 470, 420);
  picture.caption =
      "The hemisphere seen along the normal, light from the right: colour is f_r, dots are readings, white was not "
      "measured; square: retro-reflection, circle: mirror direction. Rings at 30, 60 and 90 deg.";
  picture.script += kPalette;
  picture.script += fmt::format(
      "set view map; set size ratio -1; unset xtics; unset ytics; unset border; unset key; set pm3d corners2color "
      "mean\n"
      "set xrange [-95:95]; set yrange [-95:95]; set cblabel 'f_r [sr⁻¹]'; set format cb '%.3g'; set angles degrees\n"
      "set cbrange [{:.6g}:{:.6g}]\n{}",
      scale.least, scale.most, scale.is_log ? "set logscale cb\n" : "");
  picture.script += "set parametric; set urange [0:360]; set vrange [0:1]; set isosamples 73,2; set samples 73\n";
  for (std::size_t n = 0; n < groups.size(); ++n) {
    const std::string grid = table_name(view, "polar", n);
    const std::string dots = table_name(view, "polar-readings", n);
    picture.tables.emplace_back(grid, hemisphere_table(view, groups[n], scale));
    picture.tables.emplace_back(dots, readings_table(groups[n]));
    const double t = groups[n].theta_i_deg;
    picture.script += fmt::format("set title 'θᵢ = {:.4g}°'\n", t);
    picture.script +=
        "set style textbox opaque noborder fc rgb '#f2ffffff' margins 0.6,0.6\nset label 1 '30°' at 0,-30 center front "
        "boxed font ',8'; set label 2 '60°' at 0,-60 center front boxed font ',8'; set label 3 '90°' at 0,-91 center "
        "front boxed font ',8'\n";
    picture.script += fmt::format(
        "splot {} using 1:2:3 with pm3d, for [ring in '30 60 90'] ring*cos(u),ring*sin(u),0 with lines lc rgb "
        "'#999999' dt 3 nocontour, {} using 1:2:(0) with points pt 7 ps 0.12 lc rgb '#60ffffff', '+' using "
        "({:.6g}):(0):(0) "
        "every ::0::0 with points pt 4 ps 1.8 lw 2 lc rgb '#d62728', '+' using ({:.6g}):(0):(0) every ::0::0 with "
        "points "
        "pt 6 ps 1.8 lw 2 lc rgb '#d62728'\n",
        in_quotes(grid), in_quotes(dots), t, -t);
  }
  picture.script += "unset multiplot\n";
  return picture;
}

Picture lobe_picture(const ChannelView& view) {
  const std::vector<IncidenceGroup> groups = incidence_groups(view.points, kPanels);
  const Scale scale = scale_of(view);
  Picture picture =
      begin_picture(view, "lobe", scale.is_log ? "f_r over directions, radius by its cube root" : "f_r over directions",
                    groups.size(), 470, 430);
  picture.caption =
      "f_r as the distance from the origin in each direction, where it was measured. Red: towards the source "
      "(retro-reflection); blue: the mirror direction; grey: the normal.";
  // One scale of colours for all panels, below them [px].
  constexpr double kScaleAbove = 54.0;
  constexpr double kScaleHeight = 10.0;
  const double reach = 1.05 * (scale.is_log ? std::cbrt(scale.most) : scale.most);
  picture.script += kPalette;
  picture.script += fmt::format(
      "set view 66,30,2.4; set view equal xyz; unset key; set border 0; unset xtics; unset ytics; unset ztics; set "
      "xyplane "
      "at "
      "0\nset xrange [{0:.6g}:{1:.6g}]; set yrange [{0:.6g}:{1:.6g}]; set zrange [0:{1:.6g}]\n"
      "set format cb ''; set cbrange [{2:.6g}:{3:.6g}]; set pm3d depthorder; set "
      "angles degrees\n{4}",
      -reach, reach, scale.least, scale.most, scale.is_log ? "set logscale cb\n" : "");
  // It is drawn with each panel, at the same place: gnuplot leaves arrows out of a panel that has none. Its words once.
  picture.script += fmt::format("set colorbox horizontal user origin screen 0.35,{:.4g} size screen 0.3,{:.4g}\n",
                                kScaleAbove / picture.height_px, kScaleHeight / picture.height_px);
  for (std::size_t n = 0; n < groups.size(); ++n) {
    const std::string grid = table_name(view, "lobe", n);
    picture.tables.emplace_back(grid, hemisphere_table(view, groups[n], scale));
    const double t = groups[n].theta_i_deg;
    if (n + 1 == groups.size()) picture.script += "set format cb '%.3g'; set cblabel 'f_r [sr⁻¹]'\n";
    picture.script += fmt::format(
        "set title 'θᵢ = {0:.4g}°'\n"
        "set arrow 1 from 0,0,0 to {1:.6g}*sin({0:.6g}),0,{1:.6g}*cos({0:.6g}) lw 2.5 lc rgb '#d62728' front\n"
        "set arrow 2 from 0,0,0 to -{1:.6g}*sin({0:.6g}),0,{1:.6g}*cos({0:.6g}) lw 2.5 lc rgb '#1f4e79' front\n"
        "set arrow 3 from 0,0,0 to 0,0,{1:.6g} nohead lw 1 dt 2 lc rgb '#888888' front\n"
        "splot {2} using 4:5:6:3 with pm3d\n",
        t, reach, in_quotes(grid));
  }
  picture.script += "unset multiplot\n";
  return picture;
}

Picture cut_picture(const ChannelView& view) {
  const std::vector<IncidenceGroup> groups = incidence_groups(view.points, kPanels);
  const Scale scale = scale_of(view);
  Picture picture = begin_picture(view, "cut", "The plane of incidence", groups.size(), 420, 320);
  picture.caption =
      "Readings in the plane of incidence with their expanded uncertainty U (95.45 %), and the surface "
      "between all readings. Dashed: retro-reflection at θᵣ = θᵢ; dotted: the mirror direction.";
  picture.script +=
      "set grid lc rgb '#dddddd'; set xrange [-92:92]; set xtics 30\n"
      "set xlabel 'θᵣ [°], mirror side negative'; set ylabel 'f_r [sr⁻¹]'\n"
      "set key at screen 0.985,0.965 right maxrows 1 samplen 2; set pointintervalbox 0\n";
  picture.script += scale.is_log ? "set logscale y; set format y '%g'\n" : "set yrange [*:*]\n";
  if (!scale.is_log && scale.least >= 0.0) picture.script += "set yrange [0:*]\n";
  for (std::size_t n = 0; n < groups.size(); ++n) {
    const std::string dots = table_name(view, "cut-readings", n);
    const std::string line = table_name(view, "cut", n);
    picture.tables.emplace_back(dots, readings_table(groups[n]));
    picture.tables.emplace_back(line, plane_table(view, groups[n]));
    const double t = groups[n].theta_i_deg;
    picture.script += fmt::format(
        "set title 'θᵢ = {0:.4g}°'\n"
        "set arrow 1 from {0:.6g}, graph 0 to {0:.6g}, graph 1 nohead dt 2 lc rgb '#d62728'\n"
        "set arrow 2 from -{0:.6g}, graph 0 to -{0:.6g}, graph 1 nohead dt 3 lc rgb '#d62728'\n"
        "plot {1} using 1:2 with lines lw 1.5 lc rgb '#35b779' title 'between readings', {2} using ($6 == 1 ? $5 : "
        "NaN):3:4 with yerrorbars pt 7 ps 0.6 lc rgb '#440154' title 'readings, U'\n",
        t, in_quotes(line), in_quotes(dots));
    picture.script += "unset key\n";  // the first panel's stands for all
  }
  picture.script += "unset multiplot\n";
  return picture;
}

}  // namespace gonio::analysis
