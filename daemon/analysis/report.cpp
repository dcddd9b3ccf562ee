#include "daemon/analysis/report.h"

#include <fmt/format.h>

#include "daemon/analysis/html.h"

namespace gonio::analysis {
namespace {

// For the screen and for paper: dark on light, a section is not torn from its heading, tables repeat theirs.
constexpr const char* kStyle = R"css(
:root { color-scheme: light; }
body { font: 14px/1.45 "DejaVu Sans", Verdana, sans-serif; color: #1a1a1a; background: #fff; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; margin: 0 0 .2rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .5rem; border-bottom: 1px solid #bbb; padding-bottom: .15rem; }
.lead { color: #555; margin: 0 0 1.2rem; }
table { border-collapse: collapse; margin: .4rem 0 .8rem; } th, td { text-align: left; vertical-align: top; padding: .14rem .8rem .14rem 0; }
thead th { border-bottom: 1px solid #888; font-weight: 600; } tbody tr { border-bottom: 1px solid #eee; }
.facts th { font-weight: normal; color: #555; white-space: nowrap; } .n { text-align: right; font-variant-numeric: tabular-nums; }
code, pre { font: 12px/1.4 "DejaVu Sans Mono", monospace; } pre { background: #f6f6f6; padding: .6rem .8rem; white-space: pre-wrap; overflow-wrap: anywhere; }
.hash { overflow-wrap: anywhere; } figure { margin: 1rem 0; } figure svg { width: 100%; height: auto; } figcaption { color: #555; font-size: .9rem; }
.note { background: #fff8e1; border-left: 3px solid #e0a800; padding: .3rem .7rem; margin: .3rem 0; }
.sign { display: flex; gap: 3rem; margin-top: 3rem; } .sign div { flex: 1; border-top: 1px solid #333; padding-top: .2rem; color: #555; }
@page { size: A4; margin: 16mm 14mm; }
@media print { body { font-size: 9.5pt; max-width: none; margin: 0; padding: 0; } h2, h2 + p { break-after: avoid; } figure, tr, .facts, .whole, .sign { break-inside: avoid; }
  thead { display: table-header-group; } pre { background: none; border: 1px solid #ccc; } .note { background: none; } code { font-size: 8pt; } }
)css";

std::string pictures_section(const ReportParts& parts) {
  if (parts.pictures.empty()) return {};
  std::string html = "<h2>Pictures</h2>\n";
  for (std::size_t n = 0; n < parts.pictures.size(); ++n) {
    html += "<figure>" + inline_svg(parts.pictures[n].svg, fmt::format("p{}-", n)) + "<figcaption>" +
            html_text(parts.pictures[n].caption) + "</figcaption></figure>\n";
  }
  return html + fmt::format("<p>Again, with their tables and scripts: <code>gonioctl data plot {}</code></p>\n",
                            parts.scan.info.id);
}

}  // namespace

std::string report_page(const ReportParts& parts) {
  const std::string title = html_text(fmt::format("{}: {}", parts.scan.info.sample, parts.scan.info.name));
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + title +
                     "</title>\n<style>" + kStyle + "</style></head><body>\n";
  html += "<h1>" + title + "</h1>\n";
  html += fmt::format("<p class=\"lead\">BRDF measurement, scan {}, {}. Report made {}.</p>\n", parts.scan.info.id,
                      daemon::scan_state_name(parts.scan.info.state), parts.made_utc);
  for (const std::string& note : parts.notes) html += "<p class=\"note\">" + html_text(note) + "</p>\n";
  html += summary_section(parts) + sample_section(parts) + chain_section(parts) + budget_section(parts) +
          checks_section(parts) + fit_section(parts) + environment_section(parts) + values_section(parts) +
          gaps_section(parts) + people_section(parts) + origins_section(parts) + pictures_section(parts);
  html += "<div class=\"sign\"><div>measured by, date</div><div>checked by, date</div></div>\n";
  return html + "</body></html>\n";
}

}  // namespace gonio::analysis
