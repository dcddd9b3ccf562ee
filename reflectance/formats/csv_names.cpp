#include "reflectance/formats/csv_names.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "reflectance/formats/text_lines.h"

namespace gonio::formats {
namespace {

constexpr double kDegreesARadian = 180.0 / std::numbers::pi;
constexpr double kNanometresAMicrometre = 1000.0;

struct Unit {
  std::string_view tail;
  double factor;
};
constexpr std::array kAngleUnits{Unit{"_deg", 1.0}, Unit{"_degree", 1.0},          Unit{"_degrees", 1.0},
                                 Unit{"_°", 1.0},   Unit{"_rad", kDegreesARadian}, Unit{"_radians", kDegreesARadian}};
constexpr std::array kValueUnits{Unit{"_per_sr", 1.0}, Unit{"_1/sr", 1.0}, Unit{"_sr^-1", 1.0}, Unit{"_sr-1", 1.0},
                                 Unit{"_sr^{-1}", 1.0}};
constexpr std::array kWavelengthUnits{Unit{"_nm", 1.0}, Unit{"_um", kNanometresAMicrometre},
                                      Unit{"_µm", kNanometresAMicrometre}, Unit{"_μm", kNanometresAMicrometre}};

struct Alias {
  std::string_view theirs;
  std::string_view ours;
};
constexpr std::array kAngles{Alias{"theta_i", "theta_i_deg"}, Alias{"phi_i", "phi_i_deg"},
                             Alias{"theta_r", "theta_r_deg"}, Alias{"phi_r", "phi_r_deg"},
                             Alias{"theta_s", "theta_r_deg"}, Alias{"phi_s", "phi_r_deg"},
                             Alias{"theta_o", "theta_r_deg"}, Alias{"phi_o", "phi_r_deg"}};
constexpr std::array kValues{Alias{"brdf", "f_per_sr"}, Alias{"f_r", "f_per_sr"}, Alias{"f", "f_per_sr"}};
constexpr std::array kWavelengths{Alias{"wavelength", "wavelength_nm"}, Alias{"lambda", "wavelength_nm"}};

constexpr std::array<std::string_view, 11> kOurNames{
    "theta_i_deg", "phi_i_deg",       "theta_r_deg", "phi_r_deg", "f_per_sr",     "U_per_sr",
    "k",           "u_shared_per_sr", "channel",     "flags",     "wavelength_nm"};

// Lower case, with one '_' for each run of blanks and brackets: "Theta_i [deg]" becomes "theta_i_deg".
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    const bool is_gap = c == '_' || std::string_view(" \t[]()").find(c) != std::string_view::npos;
    if (is_gap && (plain.empty() || plain.back() == '_')) continue;
    const bool is_capital = c >= 'A' && c <= 'Z';
    plain += is_gap ? '_' : is_capital ? static_cast<char>(c - 'A' + 'a') : c;
  }
  while (plain.ends_with('_')) plain.pop_back();
  return plain;
}

template <class Aliases, class Units>
std::optional<CsvColumn> column_among(const std::string& plain, const Aliases& aliases, const Units& units) {
  for (const Alias& alias : aliases) {
    if (plain == alias.theirs) return CsvColumn{.name = std::string(alias.ours), .factor = std::nullopt};
    for (const Unit& unit : units) {
      if (plain == std::string(alias.theirs).append(unit.tail))
        return CsvColumn{.name = std::string(alias.ours), .factor = unit.factor};
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<CsvColumn> csv_column(std::string_view name) {
  if (std::ranges::count(kOurNames, name) > 0) return CsvColumn{.name = std::string(name), .factor = 1.0};
  const std::string plain = plain_name(name);
  if (plain == "brdf") return CsvColumn{.name = "f_per_sr", .factor = 1.0};  // the quantity has this unit only
  if (auto angle = column_among(plain, kAngles, kAngleUnits)) return angle;
  if (auto value = column_among(plain, kValues, kValueUnits)) return value;
  return column_among(plain, kWavelengths, kWavelengthUnits);
}

char csv_separator(std::string_view names) {
  constexpr std::array kSeparators{',', ';', '\t'};
  return *std::ranges::max_element(kSeparators, {}, [&](char c) { return std::ranges::count(names, c); });
}

bool is_csv_header(std::string_view names) {
  bool has_angle = false;
  bool has_value = false;
  for (const std::string_view cell : split(names, csv_separator(names))) {
    const std::optional<CsvColumn> column = csv_column(unquoted(cell));
    has_angle = has_angle || (column && column->name == "theta_i_deg");
    has_value = has_value || (column && column->name == "f_per_sr");
  }
  return has_angle && has_value;
}

bool is_separator_line(std::string_view line) {
  constexpr std::string_view kKey = "sep=";
  return line.starts_with(kKey) && line.size() <= kKey.size() + 1;
}

std::string_view unquoted(std::string_view cell) {
  const std::string_view filled = trimmed(cell);
  const bool is_quoted = filled.size() >= 2 && filled.front() == '"' && filled.back() == '"';
  return is_quoted ? trimmed(filled.substr(1, filled.size() - 2)) : filled;
}

}  // namespace gonio::formats
