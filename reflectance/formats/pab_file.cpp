#include "reflectance/formats/pab_file.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "reflectance/formats/text_lines.h"
#include "reflectance/formats/writer_losses.h"

namespace gonio::formats {
namespace {

struct Incidence {
  double theta_deg;
  double phi_deg;
  std::uint32_t channel;
  std::string rows;
};

bool is_of(const Incidence& incidence, const BrdfPoint& p) {
  constexpr Angle kSame = degrees(0.01);
  const Geometry apart{.theta_i = degrees(incidence.theta_deg),
                       .phi_i = degrees(incidence.phi_deg),
                       .theta_r = degrees(p.theta_i_deg),
                       .phi_r = degrees(p.phi_i_deg)};
  return incidence.channel == p.channel && phase_angle(apart) <= kSame;
}

std::string pab_text(const MeasuredBrdf& brdf, const Incidence& incidence) {
  std::string name = one_line(brdf.metadata.sample);
  std::ranges::replace(name, '"', '\'');
  return fmt::format("#sample_name \"{}\"\n#format: theta phi BSDF\n#intheta {}\n#inphi {}\n#upphi 0\n{}", name,
                     incidence.theta_deg, incidence.phi_deg, incidence.rows);
}

}  // namespace

Result<Export> write_pab(const MeasuredBrdf& brdf) {
  constexpr std::size_t kMostIncidences = 1000;
  GONIO_TRY(check(brdf, "pab text"));
  std::vector<Incidence> incidences;
  for (const BrdfPoint& point : brdf.points) {
    const BrdfPoint p = in_plain_ranges(point);
    auto at = std::ranges::find_if(incidences, [&](const Incidence& one) { return is_of(one, p); });
    if (at == incidences.end()) {
      if (incidences.size() == kMostIncidences)
        return failure({.code = ErrorCode::InvalidInput,
                        .tried = "write pab text",
                        .seen = fmt::format("more than {} incidences", kMostIncidences),
                        .limit = "a file for each of them"});
      at = incidences.insert(incidences.end(), {p.theta_i_deg, p.phi_i_deg, p.channel, ""});
    }
    at->rows += fmt::format("{} {} {}\n", p.theta_r_deg, p.phi_r_deg, p.f_per_sr);
  }
  Export written;
  written.losses = losses_of_bare_values(brdf);
  add_loss(written.losses, LossKind::Metadata, 1, "the format names the sample and nothing else");
  for (const Incidence& one : incidences) {
    const auto rounded = [](double angle) { return number_text(std::round(angle * 100.0) / 100.0); };
    written.files.push_back({.suffix = fmt::format("{}-{}-{}.dat", channel_suffix(brdf, one.channel),
                                                   rounded(one.theta_deg), rounded(one.phi_deg)),
                             .bytes = pab_text(brdf, one)});
  }
  return written;
}

}  // namespace gonio::formats
