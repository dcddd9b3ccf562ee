#include "daemon/analysis/plot_scan.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

namespace gonio::analysis {
namespace {

using daemon::HistoryReading;
using daemon::HistoryVisit;

constexpr double kSecondsAMinute = 60.0;
constexpr double kPercentOf = 100.0;

double minutes_after(UtcTime at, UtcTime start) {
  return in_seconds(at - start) / kSecondsAMinute;
}

std::string readings_history(const std::vector<HistoryReading>& readings) {
  double sum = 0.0;
  for (const HistoryReading& r : readings) sum += r.monitor_mean;
  const double mean = readings.empty() || sum == 0.0 ? 1.0 : sum / static_cast<double>(readings.size());
  std::string text = "# minutes monitor_percent lamp_c detector_c room_c humidity_percent\n";
  for (const HistoryReading& r : readings) {
    text += fmt::format("{:.6f} {:.6g} {:.5g} {:.5g} {:.5g} {:.4g}\n", minutes_after(r.at, readings.front().at),
                        kPercentOf * (r.monitor_mean / mean - 1.0), r.lamp_temperature_c, r.detector_temperature_c,
                        r.room_temperature_c, r.humidity_percent);
  }
  return text;
}

// One block an exposure: minutes, DN.
std::string dark_history(const std::vector<HistoryReading>& readings, std::vector<double>& exposures) {
  std::map<double, std::string> blocks;
  for (const HistoryReading& r : readings) {
    if (!r.is_dark) continue;
    blocks[r.exposure_s] += fmt::format("{:.6f} {:.8g}\n", minutes_after(r.at, readings.front().at), r.mean_dn);
  }
  std::string text = "# a block an exposure: minutes dark_dn\n";
  for (const auto& [exposure, block] : blocks) {
    exposures.push_back(exposure);
    text += block + "\n\n";
  }
  return text;
}

// Levels of one kind relative to their first, with u.
std::string visit_history(const std::vector<HistoryVisit>& visits, std::string_view kind, UtcTime start) {
  std::string text = "# minutes level_percent u_percent\n";
  double first = 0.0;
  for (const HistoryVisit& v : visits) {
    if (v.kind != kind) continue;
    if (first == 0.0) first = v.level;
    if (first == 0.0) continue;
    text += fmt::format("{:.6f} {:.6g} {:.3g}\n", minutes_after(v.at, start), kPercentOf * (v.level / first - 1.0),
                        kPercentOf * v.u_relative);
  }
  return text;
}

bool has_visits(const std::vector<HistoryVisit>& visits, std::string_view kind) {
  return std::ranges::any_of(visits, [&](const HistoryVisit& v) { return v.kind == kind; });
}

std::string dark_plot(const std::string& table, const std::vector<double>& exposures) {
  if (exposures.empty()) return "unset key; set title 'Dark: none was read'; plot NaN notitle\n";
  std::string plot = "plot ";
  for (std::size_t n = 0; n < exposures.size(); ++n) {
    plot +=
        fmt::format("{}{} index {} using 1:2 with linespoints pt 7 ps 0.4 lc palette frac {:.3f} title '{:.4g} ms'",
                    n == 0 ? "" : ", ", in_quotes(table), n,
                    0.85 * static_cast<double>(n) / static_cast<double>(std::max<std::size_t>(1, exposures.size() - 1)),
                    1e3 * exposures[n]);
  }
  return plot + "\n";
}

}  // namespace

Picture budget_picture(const std::string& stem, const std::vector<BudgetLine>& lines) {
  constexpr std::size_t kMostLines = 14;
  const std::size_t n = std::min(lines.size(), kMostLines);
  Picture picture{.name = "budget", .caption = {}, .script = {}, .tables = {}};
  picture.caption =
      "What each component does to the values: its standard uncertainty over |f_r|, the bar to the median of all "
      "points told from zero, the line on to the worst of them.";
  picture.width_px = 1000;
  picture.height_px = 140 + 28 * static_cast<int>(n);
  std::string table = "# place median_percent worst_percent name\n";
  for (std::size_t k = 0; k < n; ++k) {
    table += fmt::format("{} {:.6g} {:.6g} \"{}\"\n", n - k, kPercentOf * lines[k].median, kPercentOf * lines[k].worst,
                         lines[k].name);
  }
  const std::string name = stem + "-budget.dat";
  picture.tables.emplace_back(name, std::move(table));
  picture.script = fmt::format(
      "set title 'Budget: standard uncertainty over |f_r|'\nset xlabel 'u / |f_r| [%]'; set yrange [0.3:{0:.1f}]; set "
      "xrange [0:*]; set grid x lc rgb '#dddddd'; unset key; set boxwidth 0.7; set style fill solid 0.9 noborder\n"
      "set ytics nomirror scale 0; set lmargin 44; set border 1\n"
      "plot {1} using (0):1:(0):2:($1-0.34):($1+0.34):ytic(4) with boxxyerror lc rgb '#31688e', {1} using "
      "2:1:($3-$2):(0) with vectors nohead lw 1.5 lc rgb '#440154', {1} using 3:1 with points pt 2 ps 0.7 lc rgb "
      "'#440154'\n",
      static_cast<double>(n) + 0.7, in_quotes(name));
  return picture;
}

Picture drift_picture(const std::string& stem, const daemon::ScanHistory& history) {
  Picture picture{.name = "drift", .caption = {}, .script = {}, .tables = {}};
  picture.caption =
      "The scan's course: the lamp's monitor and the levels that visits of the standard and of the sample saw, the "
      "dark by exposure, and the environment.";
  picture.width_px = 1200;
  picture.height_px = 760;
  const std::string readings = stem + "-drift-readings.dat";
  const std::string darks = stem + "-drift-dark.dat";
  picture.tables.emplace_back(readings, readings_history(history.readings));
  std::vector<double> exposures;
  picture.tables.emplace_back(darks, dark_history(history.readings, exposures));
  std::string& s = picture.script;
  s = "set palette defined (0 '#440154', 1 '#31688e', 2 '#35b779', 3 '#fde725'); unset colorbox\nset multiplot layout "
      "2,2 title 'Course of the scan' font ',15'\nset grid lc rgb '#dddddd'; set xlabel 'minutes since the "
      "first reading'; set key top left samplen 1 font ',9'\nset offsets graph 0.03, graph 0.03, graph 0.06, graph "
      "0.06\n";
  s += fmt::format(
      "set title 'Lamp monitor'; set ylabel 'from its mean [%]'\nplot {} using 1:2 with points pt 7 ps 0.25 lc "
      "rgb '#31688e' notitle\n",
      in_quotes(readings));
  s += "set title 'Visits'; set ylabel 'level, from the first [%]'\n";
  std::string plot;
  const UtcTime start = history.readings.empty() ? UtcTime{} : history.readings.front().at;
  for (const auto& [kind, colour] : {std::pair{"reference", "#440154"}, std::pair{"check", "#35b779"}}) {
    if (!has_visits(history.visits, kind)) continue;
    const std::string name = fmt::format("{}-drift-{}.dat", stem, kind);
    picture.tables.emplace_back(name, visit_history(history.visits, kind, start));
    plot += fmt::format("{}{} using 1:2:3 with yerrorlines pt 7 ps 0.6 lc rgb '{}' title '{}, u'",
                        plot.empty() ? "plot " : ", ", in_quotes(name), colour, kind);
  }
  s += plot.empty() ? "set title 'Visits: the plan has none'; unset tics; set yrange [0:1]; plot [0:1] NaN notitle; "
                      "set tics; set "
                      "autoscale\n"
                    : plot + "\n";
  s += "set title 'Dark'; set ylabel 'mean [DN]'; set key outside right\n" + dark_plot(darks, exposures);
  // Above the curves there is room for the key.
  s += fmt::format(
      "set key inside top left; set offsets graph 0.03, graph 0.03, graph 0.45, graph 0.06\n"
      "set title 'Environment'; set ylabel 'temperature [°C]'; set y2label 'humidity [%]'; set y2tics; set ytics "
      "nomirror\nplot {0} using 1:3 with lines lc rgb '#d62728' title 'lamp', {0} using 1:4 with lines lc rgb "
      "'#440154' title 'detector', {0} using 1:5 with lines lc rgb '#31688e' title 'room', {0} using 1:6 axes "
      "x1y2 with lines lc rgb '#35b779' title 'humidity (right)'\nunset multiplot\n",
      in_quotes(readings));
  return picture;
}

}  // namespace gonio::analysis
