#include "reflectance/convention/notation.h"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>

namespace gonio::reflectance {
namespace {

constexpr std::array<NotationRow, 26> kRows{{
    {"angle of incidence, from the normal", "rad", "theta_i", "i", "theta_i", "theta'"},
    {"azimuth of incidence", "rad", "phi_i", "", "phi_i", "phi'"},
    {"angle of reflection, from the normal", "rad", "theta_r", "e", "theta_r", "theta"},
    {"azimuth of reflection", "rad", "phi_r", "", "phi_r", "phi"},
    {"azimuth between the planes of incidence and reflection", "rad", "phi_r - phi_i", "psi", "", ""},
    {"cosine of the angle of incidence", "", "mu_i", "mu_0", "cos(theta_i)", "mu'"},
    {"cosine of the angle of reflection", "", "mu_r", "mu", "cos(theta_r)", "mu"},
    {"phase angle, between the directions to source and detector", "rad", "xi", "g", "", ""},
    {"scattering angle, between the ways of the light before and after", "rad", "psi", "theta", "", "psi"},
    {"solid angle", "sr", "Omega", "Omega", "omega", "Omega"},
    {"projected solid angle", "sr", "mu Omega", "", "Omega", ""},
    {"radiance", "W m^-2 sr^-1", "L", "I", "L", "L"},
    {"irradiance across a collimated beam", "W m^-2", "", "J", "", ""},
    {"irradiance on the surface", "W m^-2", "E_d", "mu_0 J", "E_i", "E_d"},
    {"BRDF", "sr^-1", "BRDF", "r/mu_0", "f_r", "r/cos(theta')"},
    {"bidirectional reflectance, the BRDF times mu_i", "sr^-1", "r", "r", "", "r"},
    {"reflectance factor, pi times the BRDF", "", "REFF", "REFF", "R", ""},
    {"radiance factor, pi times the BRDF times mu_i", "", "I/F", "RADF", "", ""},
    {"directional-hemispherical reflectance, plane albedo", "", "rho_dh", "r_h", "rho(theta_i,phi_i;2pi)", ""},
    {"hemispherical-directional reflectance", "", "rho_hd", "", "rho(2pi;theta_r,phi_r)", ""},
    {"bihemispherical reflectance in isotropic light, Bond albedo", "", "A", "r_s", "rho(2pi;2pi)", ""},
    {"irradiance reflectance in the given light", "", "R", "", "", "R"},
    {"remote-sensing reflectance", "sr^-1", "R_rs", "", "", "R_rs"},
    {"single-scattering albedo", "", "omega0", "w", "", "omega0"},
    {"asymmetry parameter, mean cosine of the scattering angle", "", "g", "xi", "", "g"},
    {"square root of 1 less the single-scattering albedo", "", "gamma", "gamma", "", ""},
}};

std::string_view symbol_in(const NotationRow& row, Notation book) {
  switch (book) {
    case Notation::Notes:
      return row.notes;
    case Notation::Hapke:
      return row.hapke;
    case Notation::Nbs160:
      return row.nbs160;
    case Notation::LightAndWater:
      return row.light_and_water;
  }
  return {};
}

constexpr std::array<Notation, 4> kBooks{Notation::Notes, Notation::Hapke, Notation::Nbs160, Notation::LightAndWater};

bool is_clashing(std::string_view symbol) {
  std::set<const NotationRow*> meanings;
  for (const Notation book : kBooks) meanings.insert(find_symbol(book, symbol));
  meanings.erase(nullptr);
  return meanings.size() > 1;
}

}  // namespace

std::span<const NotationRow> notation_rows() {
  return kRows;
}

const NotationRow* find_symbol(Notation book, std::string_view symbol) {
  if (symbol.empty()) return nullptr;
  const auto row =
      std::find_if(kRows.begin(), kRows.end(), [&](const NotationRow& r) { return symbol_in(r, book) == symbol; });
  return row == kRows.end() ? nullptr : &*row;
}

std::vector<std::string_view> clashing_symbols() {
  std::set<std::string_view> clashing;
  for (const NotationRow& row : kRows) {
    for (const Notation book : kBooks) {
      const std::string_view symbol = symbol_in(row, book);
      if (is_clashing(symbol)) clashing.insert(symbol);
    }
  }
  return {clashing.begin(), clashing.end()};
}

std::string notation_table() {
  std::string text =
      "| quantity | unit | notes, and here | Hapke (1993) | NBS 160 | Light and Water |\n|---|---|---|---|---|---|\n";
  const auto code = [](std::string_view s) { return s.empty() ? std::string() : fmt::format("`{}`", s); };
  for (const NotationRow& row : kRows) {
    text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", row.quantity, row.unit, code(row.notes), code(row.hapke),
                        code(row.nbs160), code(row.light_and_water));
  }
  return text;
}

}  // namespace gonio::reflectance
