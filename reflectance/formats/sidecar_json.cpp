#include "reflectance/formats/sidecar_json.h"

#include <array>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "reflectance/formats/json_object.h"
#include "reflectance/formats/metadata_texts.h"

namespace gonio::formats {
namespace {

using nlohmann::ordered_json;
using reflectance::TableSymmetry;

constexpr std::string_view kSidecarFormat = "gonio-brdf";
constexpr std::size_t kSidecarVersion = 1;

struct NumberField {
  std::string_view key;
  std::optional<double> BrdfMetadata::*field;
};
constexpr std::array kNumberFields{NumberField{"temperature_c", &BrdfMetadata::temperature_c},
                                   NumberField{"beam_area_mm2", &BrdfMetadata::beam_area_mm2},
                                   NumberField{"detector_solid_angle_sr", &BrdfMetadata::detector_solid_angle_sr}};

// In the order of their enumerations; the empty one is what an absent key says.
const std::vector<std::string_view> kSidecarSymmetries{"", "isotropic", "turn", "anisotropic"};
const std::vector<std::string_view> kSidecarMethods{"measurement", "simulation"};
const std::vector<std::string_view> kSidecarPolarisations{"", "unpolarised", "s", "p"};

ordered_json metadata_json(const BrdfMetadata& metadata) {
  ordered_json said = ordered_json::object();
  said["method"] = kSidecarMethods[static_cast<std::size_t>(metadata.method)];
  for (const MetadataText& text : kMetadataTexts)
    if (!(metadata.*text.field).empty()) said[std::string(text.key)] = metadata.*text.field;
  if (metadata.symmetry) said["symmetry"] = kSidecarSymmetries[1 + static_cast<std::size_t>(*metadata.symmetry)];
  for (const NumberField& number : kNumberFields)
    if (metadata.*number.field) said[std::string(number.key)] = *(metadata.*number.field);
  if (!metadata.references.empty()) said["references"] = metadata.references;
  ordered_json remarks = ordered_json::array();
  for (const auto& [key, text] : metadata.remarks) remarks.push_back({{"key", key}, {"text", text}});
  if (!remarks.empty()) said["remarks"] = remarks;
  return said;
}

ordered_json channel_json(const Channel& channel) {
  ordered_json said{{"name", channel.name}};
  if (channel.wavelength_nm > 0.0) said["wavelength_nm"] = channel.wavelength_nm;
  const auto put = [&](const char* key, Polarisation p) {
    if (p != Polarisation::Unknown) said[key] = kSidecarPolarisations[static_cast<std::size_t>(p)];
  };
  put("polarisation_i", channel.incident);
  put("polarisation_r", channel.reflected);
  return said;
}

BrdfMetadata metadata_from(const JsonObject& said) {
  BrdfMetadata metadata;
  metadata.method = static_cast<Method>(said.choice("method", kSidecarMethods));
  for (const MetadataText& text : kMetadataTexts) metadata.*text.field = said.text(text.key);
  const std::size_t symmetry = said.choice("symmetry", kSidecarSymmetries);
  if (symmetry > 0) metadata.symmetry = static_cast<TableSymmetry>(symmetry - 1);
  for (const NumberField& number : kNumberFields) metadata.*number.field = said.number(number.key);
  metadata.references = said.texts("references");
  for (const JsonObject& remark : said.objects("remarks"))
    metadata.remarks.emplace_back(remark.text("key"), remark.text("text"));
  return metadata;
}

Channel channel_from(const JsonObject& said) {
  said.require("name");
  return {.name = said.text("name"),
          .wavelength_nm = said.number("wavelength_nm").value_or(0.0),
          .incident = static_cast<Polarisation>(said.choice("polarisation_i", kSidecarPolarisations)),
          .reflected = static_cast<Polarisation>(said.choice("polarisation_r", kSidecarPolarisations))};
}

}  // namespace

std::string sidecar_json(const MeasuredBrdf& brdf) {
  ordered_json said{{"format", kSidecarFormat}, {"version", kSidecarVersion}, {"points", brdf.points.size()}};
  said["metadata"] = metadata_json(brdf.metadata);
  said["channels"] = ordered_json::array();
  for (const Channel& channel : brdf.channels) said["channels"].push_back(channel_json(channel));
  said["flags"] = brdf.flag_names;
  // Bytes that are not UTF-8 become replacement characters: a sample's name must not stop an export.
  return said.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<Sidecar> read_sidecar_json(std::string_view text, const std::string& file) {
  JsonSource source{.format = "the sidecar of a CSV", .file = file};
  const Result<nlohmann::json> parsed = parse_json(text, source);
  if (!parsed) return failure(parsed.error());
  const JsonObject root(&*parsed, "", source);
  if (root.text("format") != kSidecarFormat) root.fail("format", "another format", std::string(kSidecarFormat));
  if (root.whole("version") > kSidecarVersion) root.fail("version", "a newer one", fmt::format("{}", kSidecarVersion));
  Sidecar sidecar;
  sidecar.points = root.whole("points");
  sidecar.brdf.metadata = metadata_from(root.object("metadata"));
  for (const JsonObject& channel : root.objects("channels")) sidecar.brdf.channels.push_back(channel_from(channel));
  sidecar.brdf.flag_names = root.texts("flags");
  if (source.error) return failure(std::move(*source.error));
  return sidecar;
}

}  // namespace gonio::formats
