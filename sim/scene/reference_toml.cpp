// The reference standard's file.
#include <fmt/format.h>

#include "sim/scene/papers.h"
#include "sim/scene/spectralon_shape.h"

namespace gonio::sim {
namespace {

std::string_view kind_name(ModeKind kind) {
  switch (kind) {
    case ModeKind::Limb:
      return "limb";
    case ModeKind::Forward:
      return "forward";
    case ModeKind::Sideways:
      return "sideways";
    case ModeKind::Opposition:
      return "opposition";
  }
  return {};
}

std::string certificate_section(const ReferenceSpec& reference) {
  std::string text = fmt::format(
      "\n[certificate]\ndate = {}\nexpires = {}\ngeometry = \"8/h\"\nspecular = \"included\"\ncoverage_factor = "
      "{:.1f}\n"
      "uncertainty_kind = \"absolute\"\n",
      reference.certificate_date, reference.expires, reference.coverage_factor);
  if (reference.certificate.size() > 1) {
    Wavelength gap;
    for (std::size_t k = 1; k < reference.certificate.size(); ++k) {
      gap = std::max(gap, reference.certificate[k].wavelength - reference.certificate[k - 1].wavelength);
    }
    text += fmt::format("longest_gap_nm = {:.10g}\n", in_nanometres(gap));
  }
  for (const CertificateEntry& entry : reference.certificate) {
    text += fmt::format("[[certificate.entries]]\nwavelength_nm = {:.10g}\nreflectance = {}\nuncertainty = {}\n",
                        in_nanometres(entry.wavelength), entry.reflectance, entry.uncertainty);
  }
  return text;
}

std::string table_values(const ShapeGrid& grid) {
  const SpectralonShape shape;
  std::string text = "values = [";
  for (const double theta_i : grid.theta_deg) {
    for (const double theta_r : grid.theta_deg) {
      text += "\n ";
      for (const double phi : grid.phi_deg) {
        text += fmt::format(" {:.5f},", shape({degrees(theta_i), Angle{}, degrees(theta_r), degrees(phi)}));
      }
    }
  }
  return text + "\n]\n";
}

}  // namespace

std::string reference_toml(const ReferenceSpec& reference) {
  const ShapeGrid grid = shape_grid();
  std::string text = fmt::format(
      "# The reference standard on the simulated carriage, written by goniosim.\n[standard]\nserial = \"{}\"\nmaterial "
      "= \"{}\"\n",
      reference.serial, reference.material);
  text += certificate_section(reference);
  text += fmt::format("\n[shape]\ntheta_i_deg = [{0}]\ntheta_r_deg = [{0}]\nphi_deg = [{1}]\nu_integral = {2}\n",
                      fmt::join(grid.theta_deg, ", "), fmt::join(grid.phi_deg, ", "), reference.u_integral);
  text += table_values(grid);
  for (std::size_t k = 0; k < reference.modes.size(); ++k) {
    const ShapeMode& mode = reference.modes[k];
    text += fmt::format("[[shape.modes]]\nname = \"{0}-{1}\"\nkind = \"{0}\"\nu = {2}\n", kind_name(mode.kind), k + 1,
                        mode.u);
    if (mode.kind == ModeKind::Opposition) text += fmt::format("width_deg = {:.10g}\n", in_degrees(mode.width));
  }
  return text;
}

}  // namespace gonio::sim
