#include "bench/reflectance/cases.h"

#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <utility>

#include "reflectance/surface/make_surface.h"

namespace gonio::bench {
namespace {

using reflectance::Direction;
using reflectance::Feature;
using reflectance::Parameters;
using reflectance::Surface;

struct FormulaHidden {
  Surface surface;
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const { return surface.eval(i, r); }
  [[nodiscard]] std::string_view model() const { return "formula_hidden"; }
  [[nodiscard]] Parameters parameters() const { return surface.parameters(); }
  [[nodiscard]] bool is_isotropic() const { return surface.is_isotropic(); }
  [[nodiscard]] Feature feature() const { return surface.feature(); }
};

using Rows = std::initializer_list<std::pair<double, double>>;

void add(std::vector<Case>& cases, const char* name, const Surface& surface, Rows rows) {
  for (const auto& [theta_i_deg, rho_dh] : rows) cases.push_back({name, surface, theta_i_deg, rho_dh});
}

}  // namespace

Surface surface_of(std::string_view model, const Parameters& parameters) {
  Result<Surface> surface = reflectance::make_surface(model, parameters);
  if (surface) return *surface;
  std::fprintf(stderr, "%s\n", describe(surface.error()).c_str());
  std::exit(2);
}

Surface with_formula_hidden(const Surface& surface) {
  return FormulaHidden{surface};
}

// Minnaert and Hapke: closed forms evaluated with 25 digits or more. RPV: two forms of polar coordinates, tanh-sinh.
// glint, 0.0542: two independent quadratures. hapke_hg and glint, 0.001: reference_values.py beside this file.
std::vector<Case> rho_dh_cases() {
  const Surface minnaert = surface_of("minnaert", {{"rho", 0.5}, {"k", 0.5}});
  const Surface hapke = surface_of("hapke", {{"omega0", 0.9}});
  const Surface hapke_hg = surface_of("hapke_hg", {{"omega0", 0.9}, {"g", -0.3}});
  const Surface wheat = surface_of("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}});
  const Surface sea = surface_of("cox_munk", {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}});
  const Surface sea_smith = surface_of("cox_munk_smith", {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}});
  const Surface lobe = surface_of("glint", {{"slope_variance", 1e-3}, {"refractive_index", 1.34}});

  std::vector<Case> cases;
  const Rows minnaert_rows = {{0, 0.4}, {30, 0.372241943640840}, {60, 0.282842712474619}, {85, 0.118088605883994}};
  const Rows hapke_rows = {
      {0, 0.404754959067831}, {30, 0.423913459401245}, {60, 0.486743912359091}, {85, 0.599393872596226}};
  add(cases, "minnaert k=.5", minnaert, minnaert_rows);
  add(cases, "minnaert k=.5, formula hidden", with_formula_hidden(minnaert), minnaert_rows);
  add(cases, "hapke .9", hapke, hapke_rows);
  add(cases, "hapke .9, formula hidden", with_formula_hidden(hapke), hapke_rows);
  add(cases, "hapke_hg .9 g=-.3", hapke_hg,
      {{0, 0.492742312333336}, {30, 0.504524815835568}, {60, 0.542060480563369}, {85, 0.610060824216936}});
  add(cases, "rpv wheat", wheat,
      {{0, 0.742575513854292},
       {30, 0.734215727909711},
       {60, 0.712386680567085},
       {80, 0.713447834768679},
       {85, 0.747348019118055}});
  add(cases, "glint W=10", sea,
      {{0, 0.0211735434107334},
       {30, 0.0232881722959141},
       {60, 0.0620081099133315},
       {75, 0.151030730145936},
       {85, 0.376287594971279}});
  add(cases, "glint_smith W=10", sea_smith,
      {{0, 0.0211735035186920},
       {30, 0.0232564147586820},
       {60, 0.0585238108747566},
       {75, 0.133536030301337},
       {85, 0.252164369204699}});
  add(cases, "glint, variance .001", lobe,
      {{0, 0.0211118640955752}, {30, 0.0222167240339816}, {60, 0.0611882167918665}, {75, 0.214241006000939}});
  return cases;
}

}  // namespace gonio::bench
