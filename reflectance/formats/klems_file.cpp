#include "reflectance/formats/klems_file.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "reflectance/formats/text_lines.h"

namespace gonio::formats {
namespace {

using reflectance::Direction;

struct KlemsRing {
  double lower_deg;
  double upper_deg;
  int patches;
};
constexpr std::array<KlemsRing, 9> kKlemsRings{{{0, 5, 1},
                                                {5, 15, 8},
                                                {15, 25, 16},
                                                {25, 35, 20},
                                                {35, 45, 24},
                                                {45, 55, 24},
                                                {55, 65, 24},
                                                {65, 75, 16},
                                                {75, 90, 12}}};

// A patch by four directions, each for a quarter of its projected solid angle.
using Patch = std::array<Direction, 4>;

Patch patch_at(const KlemsRing& ring, int number, double turned_by) {
  const double least = std::pow(std::sin(degrees(ring.lower_deg).si()), 2);
  const double most = std::pow(std::sin(degrees(ring.upper_deg).si()), 2);
  Patch patch;
  std::size_t n = 0;
  for (const double along : {0.25, 0.75}) {
    for (const double aside : {-0.25, 0.25}) {
      const double theta = std::asin(std::sqrt(least + along * (most - least)));
      const double phi = 2.0 * std::numbers::pi * (number + aside) / ring.patches + turned_by;
      patch[n++] = Direction::from_angles(radians(theta), radians(phi));
    }
  }
  return patch;
}

std::vector<Patch> klems_basis(double turned_by) {
  std::vector<Patch> basis;
  for (const KlemsRing& ring : kKlemsRings)
    for (int number = 0; number < ring.patches; ++number) basis.push_back(patch_at(ring, number, turned_by));
  return basis;
}

double mean_brdf(GridReader& values, const Patch& incident, const Patch& reflected) {
  double sum = 0.0;
  for (const Direction& i : incident)
    for (const Direction& r : reflected) sum += values.at_least_zero(i, r);
  return sum / static_cast<double>(incident.size() * reflected.size());
}

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : one_line(text)) {
    if (c == '&') safe += "&amp;";
    if (c == '<') safe += "&lt;";
    if (c == '>') safe += "&gt;";
    if (c != '&' && c != '<' && c != '>') safe += c;
  }
  return safe;
}

std::string basis_xml() {
  std::string xml = "<AngleBasis>\n<AngleBasisName>LBNL/Klems Full</AngleBasisName>\n";
  for (const KlemsRing& ring : kKlemsRings) {
    xml += fmt::format(
        "<AngleBasisBlock><Theta>{}</Theta><nPhis>{}</nPhis><ThetaBounds><LowerTheta>{}</LowerTheta>"
        "<UpperTheta>{}</UpperTheta></ThetaBounds></AngleBasisBlock>\n",
        ring.lower_deg == 0.0 ? 0.0 : 0.5 * (ring.lower_deg + ring.upper_deg), ring.patches, ring.lower_deg,
        ring.upper_deg);
  }
  return xml + "</AngleBasis>\n";
}

// The incident patch fastest: a line for each patch of reflection.
std::string values_xml(GridReader& values) {
  const std::vector<Patch> incident = klems_basis(std::numbers::pi);
  const std::vector<Patch> reflected = klems_basis(0.0);
  std::string xml;
  for (const Patch& r : reflected) {
    std::string_view gap;
    for (const Patch& i : incident) {
      xml += fmt::format("{}{:.6e}", gap, mean_brdf(values, i, r));
      gap = ",";
    }
    xml += ",\n";
  }
  return xml;
}

std::string klems_xml(const SurfaceFile& file, const ChannelSurface& one, GridReader& values) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<WindowElement xmlns=\"http://windows.lbl.gov\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n"
      "<WindowElementType>System</WindowElementType>\n<Optical>\n<Layer>\n";
  xml += fmt::format("<Material><Name>{}</Name><Manufacturer>{}</Manufacturer></Material>\n",
                     escaped(file.metadata.sample), escaped(file.metadata.organisation));
  xml += "<DataDefinition>\n<IncidentDataStructure>Columns</IncidentDataStructure>\n" + basis_xml() +
         "</DataDefinition>\n<WavelengthData>\n<LayerNumber>System</LayerNumber>\n";
  xml += one.channel.wavelength_nm > 0.0
             ? fmt::format("<Wavelength unit=\"nm\">{}</Wavelength>\n", one.channel.wavelength_nm)
             : std::string("<Wavelength unit=\"Integral\">Visible</Wavelength>\n");
  xml +=
      "<WavelengthDataBlock>\n<WavelengthDataDirection>Reflection Back</WavelengthDataDirection>\n"
      "<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>\n<RowAngleBasis>LBNL/Klems Full</RowAngleBasis>\n"
      "<ScatteringDataType>BRDF</ScatteringDataType>\n<ScatteringData>\n";
  xml += values_xml(values);
  return xml + "</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n</Layer>\n</Optical>\n</WindowElement>\n";
}

}  // namespace

Result<Export> write_klems(const SurfaceFile& file) {
  GONIO_TRY(check(file, "Klems XML"));
  Export written{.files = {}, .losses = file.losses};
  for (std::size_t n = 0; n < file.channels.size(); ++n) {
    GridReader values(file.channels[n]);
    written.files.push_back(
        {.suffix = channel_suffix(file, n) + ".xml", .bytes = klems_xml(file, file.channels[n], values)});
    values.add_losses(written.losses);
  }
  add_loss(written.losses, LossKind::Precision, file.channels.size(), "values are means over patches 10 deg wide");
  add_loss(written.losses, LossKind::Metadata, 1, "the format names the sample and its maker");
  return written;
}

}  // namespace gonio::formats
