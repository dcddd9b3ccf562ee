#include "calibration/reference_definition.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "base/toml_reader.h"

namespace gonio::calibration {
namespace {

constexpr std::array<std::string_view, 3> kGeometries = {"8/h", "h/8", "0/45"};
constexpr std::array<std::string_view, 2> kSpecular = {"included", "excluded"};
constexpr std::array<std::string_view, 2> kUncertaintyKinds = {"absolute", "relative"};
constexpr std::array<std::string_view, 4> kModeKinds = {"limb", "forward", "sideways", "opposition"};
constexpr std::size_t kModesAtMost = 8;
// A hemisphere's certificate weighs directions with cos(theta): a table that ends at 70 deg leaves 12 % of it to a
// guess, as far as public tables of white standards leave it.
constexpr Angle kLeastReach = degrees(70.0);

// What a certificate must say, or nobody knows what its numbers mean.
void demand(TomlReader& reader, std::string_view key, std::string_view why) {
  if (reader.kind(key) == TomlKind::Absent) {
    reader.fail(key, ErrorCode::ReferenceIncomplete, fmt::format("{} is missing", key), std::string(why));
  }
}

std::vector<CertificateEntry> read_entries(TomlReader& reader, double coverage_factor, bool relative) {
  std::vector<CertificateEntry> entries;
  for (TomlReader& row : reader.tables("entries")) {
    CertificateEntry entry;
    entry.wavelength = nanometres(row.number("wavelength_nm", {.least = 100.0, .most = 1e5, .unit = "nm"}));
    entry.reflectance = row.number("reflectance", {.least = 1e-4, .most = 2.0});
    entry.u = row.number("uncertainty", {.least = 0.0, .most = 1.0}) / coverage_factor;
    if (relative) entry.u *= entry.reflectance;
    if (!entries.empty() && entry.wavelength <= entries.back().wavelength) {
      row.fail("wavelength_nm", ErrorCode::InvalidInput, "the entries do not ascend", "ascending wavelengths");
    }
    entries.push_back(entry);
  }
  if (entries.empty()) {
    reader.fail("entries", ErrorCode::ReferenceIncomplete, "the certificate has no entry",
                "at least one [[certificate.entries]]");
  }
  return entries;
}

void read_specular(TomlReader& reader, Certificate& c) {
  if (c.geometry == CertificateGeometry::ZeroFortyFive) return;  // then the key is unknown: it has no meaning there
  demand(reader, "specular", "\"included\" or \"excluded\"");
  if (reader.choice("specular", kSpecular) == 1) {
    demand(reader, "specular_port_half_angle_deg", "the half angle of the open port");
    c.specular_port =
        degrees(reader.number("specular_port_half_angle_deg", {.least = 0.1, .most = 20.0, .unit = "deg"}));
  }
}

Certificate read_certificate(TomlReader reader) {
  Certificate c;
  demand(reader, "date", "the day of the calibration");
  demand(reader, "expires", "the last day on which it holds");
  demand(reader, "geometry", "\"8/h\", \"h/8\" or \"0/45\"");
  demand(reader, "coverage_factor", "the k of the stated uncertainties: it is never assumed");
  demand(reader, "uncertainty_kind", "\"absolute\" or \"relative\"");
  c.date = reader.date("date");
  c.expires = reader.date("expires");
  if (c.expires < c.date) {
    reader.fail("expires", ErrorCode::InvalidInput, "it expires on " + c.expires, "not before its date, " + c.date);
  }
  c.geometry = static_cast<CertificateGeometry>(reader.choice("geometry", kGeometries));
  read_specular(reader, c);
  c.coverage_factor = reader.number("coverage_factor", {.least = 1.0, .most = 5.0});
  const bool relative = reader.choice("uncertainty_kind", kUncertaintyKinds) == 1;
  c.entries = read_entries(reader, c.coverage_factor, relative);
  if (c.entries.size() > 1) {
    c.longest_gap = nanometres(reader.number("longest_gap_nm", {.least = 0.0, .most = 1e4, .unit = "nm"}));
  }
  c.correlation = reader.number_or("correlation", 1.0, {.least = 0.0, .most = 1.0});
  return c;
}

std::vector<Angle> read_grid(TomlReader& reader, std::string_view key, double most_deg) {
  const std::vector<double> deg = reader.numbers(key, {.least = 0.0, .most = most_deg, .unit = "deg"});
  if (deg.size() < 2 || deg.front() != 0.0 || std::ranges::adjacent_find(deg, std::greater_equal<>{}) != deg.end()) {
    reader.fail(key, ErrorCode::InvalidInput, "the grid does not ascend from 0 deg",
                "at least two ascending angles, the first of them 0");
  }
  std::vector<Angle> grid;
  for (const double value : deg) grid.push_back(degrees(value));
  return grid;
}

struct Grids {
  std::vector<Angle> theta_i;
  std::vector<Angle> theta_r;
  std::vector<Angle> phi;
  [[nodiscard]] std::size_t nodes() const { return theta_i.size() * theta_r.size() * phi.size(); }
};

// About the normal phi has no meaning: a table that varies with it there has mixed up its axes. `rows`: of all tables.
bool is_constant_at_the_pole(const std::vector<double>& values, std::size_t rows, const Grids& grids) {
  constexpr double kRoundingOfAFile = 1e-5;
  const std::size_t n_r = grids.theta_r.size();
  const std::size_t n_phi = grids.phi.size();
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t r = 0; r < n_r; ++r) {
      if (i % grids.theta_i.size() != 0 && r != 0) continue;
      const double first = values[(i * n_r + r) * n_phi];
      for (std::size_t p = 1; p < n_phi; ++p) {
        if (std::abs(values[(i * n_r + r) * n_phi + p] - first) > kRoundingOfAFile * first) return false;
      }
    }
  }
  return true;
}

// None: one shape for all wavelengths.
std::vector<Wavelength> read_wavelengths(TomlReader& reader) {
  std::vector<Wavelength> wavelengths;
  if (reader.kind("wavelengths_nm") == TomlKind::Absent) return wavelengths;
  for (const double nm : reader.numbers("wavelengths_nm", {.least = 100.0, .most = 1e5, .unit = "nm"})) {
    if (!wavelengths.empty() && nanometres(nm) <= wavelengths.back()) {
      reader.fail("wavelengths_nm", ErrorCode::InvalidInput, "they do not ascend", "ascending wavelengths");
    }
    wavelengths.push_back(nanometres(nm));
  }
  return wavelengths;
}

void check_values(TomlReader& reader, const Grids& grids, std::size_t tables, const std::vector<double>& values) {
  if (reader.has_failed()) return;
  if (values.size() != tables * grids.nodes()) {
    const std::string of_each =
        fmt::format("{} x {} x {}", grids.theta_i.size(), grids.theta_r.size(), grids.phi.size());
    reader.fail("values", ErrorCode::InvalidInput, fmt::format("{} values", values.size()),
                tables == 1 ? fmt::format("{} = {}", of_each, grids.nodes())
                            : fmt::format("{} wavelengths x {} = {}", tables, of_each, tables * grids.nodes()));
    return;
  }
  if (is_constant_at_the_pole(values, tables * grids.theta_i.size(), grids)) return;
  reader.fail("values", ErrorCode::InvalidInput, "they vary with phi at theta = 0",
              "wavelength slowest, then theta_i, then theta_r, phi fastest; one value for all phi about the normal");
}

std::vector<SpectralShape> read_shapes(TomlReader& reader) {
  const std::vector<Wavelength> wavelengths = read_wavelengths(reader);
  const std::size_t tables = std::max<std::size_t>(1, wavelengths.size());
  const Grids grids{.theta_i = read_grid(reader, "theta_i_deg", 90.0),
                    .theta_r = read_grid(reader, "theta_r_deg", 90.0),
                    .phi = read_grid(reader, "phi_deg", 180.0)};
  const auto values = reader.numbers("values", {.least = 1e-6, .most = 1e6});
  if (!reader.has_failed() && grids.phi.back() != degrees(180.0)) {
    reader.fail("phi_deg", ErrorCode::InvalidInput, fmt::format("it ends at {} deg", in_degrees(grids.phi.back())),
                "180 deg");
  }
  check_values(reader, grids, tables, values);
  if (reader.has_failed()) return {};
  std::vector<SpectralShape> shapes;
  for (std::size_t t = 0; t < tables; ++t) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(t * grids.nodes());
    shapes.push_back({wavelengths.empty() ? Wavelength{} : wavelengths[t],
                      ShapeTable(grids.theta_i, grids.theta_r, grids.phi,
                                 std::vector<double>(first, first + static_cast<std::ptrdiff_t>(grids.nodes())))});
  }
  return shapes;
}

void check_own_geometry(TomlReader& reader, const ShapeTable& table, CertificateGeometry geometry) {
  const auto demand_reach = [&](std::string_view key, const std::vector<Angle>& grid, Angle least) {
    if (grid.back() >= least) return;
    reader.fail(key, ErrorCode::ReferenceOutOfReach, fmt::format("the table ends at {} deg", in_degrees(grid.back())),
                fmt::format("the certificate's geometry {} needs it up to {} deg at least",
                            kGeometries[static_cast<std::size_t>(geometry)], in_degrees(least)));
  };
  const bool h_8 = geometry == CertificateGeometry::HemisphericalEight;
  const bool hemisphere = geometry != CertificateGeometry::ZeroFortyFive;
  demand_reach("theta_i_deg", table.theta_i(), h_8 ? kLeastReach : hemisphere ? degrees(8.0) : Angle{});
  demand_reach("theta_r_deg", table.theta_r(), h_8 ? degrees(8.0) : hemisphere ? kLeastReach : degrees(45.0));
}

std::vector<ShapeMode> read_modes(TomlReader& reader) {
  std::vector<ShapeMode> modes;
  std::set<std::string> names;
  for (TomlReader& row : reader.tables("modes")) {
    ShapeMode mode;
    mode.name = row.text("name");
    if (!names.insert(mode.name).second) {
      row.fail("name", ErrorCode::InvalidInput, "the name \"" + mode.name + "\" comes twice", "each name once");
    }
    mode.kind = static_cast<ShapeModeKind>(row.choice("kind", kModeKinds));
    mode.u = row.number("u", {.least = 0.0, .most = 0.5});
    if (mode.kind == ShapeModeKind::Opposition) {
      mode.width = degrees(row.number("width_deg", {.least = 2.0, .most = 90.0, .unit = "deg"}));
    }
    modes.push_back(std::move(mode));
  }
  if (modes.size() > kModesAtMost) {
    reader.fail("modes", ErrorCode::InvalidInput, fmt::format("{} modes", modes.size()),
                fmt::format("at most {}", kModesAtMost));
  }
  return modes;
}

}  // namespace

Result<ReferenceDefinition> parse_reference(std::string_view toml, const std::string& file) {
  Result<TomlReader> root = TomlReader::parse(toml, file);
  if (!root) return failure(std::move(root).error());
  TomlReader standard = root->table("standard");
  const std::string serial = standard.text("serial");
  const std::string material = standard.text_or("material", "");
  TomlReader certificate_table = root->table("certificate");
  const Certificate certificate = read_certificate(certificate_table);
  TomlReader shape = root->table("shape");
  ReferenceDefinition definition{.serial = serial,
                                 .material = material,
                                 .certificate = certificate,
                                 .shapes = read_shapes(shape),
                                 .modes = read_modes(shape),
                                 .expires_at = certificate_table.location("expires"),
                                 .entries_at = certificate_table.location("entries"),
                                 .shape_at = shape.location("values"),
                                 .shape_wavelengths_at = shape.location("wavelengths_nm")};
  if (!root->has_failed()) check_own_geometry(shape, definition.shapes.front().table, certificate.geometry);
  if (certificate.geometry != CertificateGeometry::ZeroFortyFive) {
    demand(shape, "u_integral", "the relative u (k = 1) of the hemisphere's integral: the cap beyond the table");
    definition.u_integral = shape.number("u_integral", {.least = 0.0, .most = 0.5});
  }
  if (const Result<void> read = root->finish(); !read) return failure(read.error());
  return definition;
}

}  // namespace gonio::calibration
