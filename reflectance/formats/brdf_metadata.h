#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reflectance/table/table_options.h"

namespace gonio::formats {

enum class Method : std::uint8_t { Measurement, Simulation };

/// What stands in a file beside its values. A text is empty, a number absent where nothing is known.
struct BrdfMetadata {
  std::string id;  ///< a URI; "" lets a writer that needs one make it of `sample`
  std::string description;
  Method method = Method::Measurement;
  std::string measured_at;  ///< ISO 8601, UTC: "2026-01-01T12:00:00Z"
  std::string software;

  std::string sample;
  std::string sample_kind;   ///< "sintered PTFE"
  std::string zero_azimuth;  ///< where phi = 0 is on the sample: "along the engraved arrow"
  std::optional<reflectance::TableSymmetry> symmetry = std::nullopt;
  std::string medium;  ///< "air", "water"
  std::optional<double> temperature_c = std::nullopt;

  std::string instrument;
  std::optional<double> beam_area_mm2 = std::nullopt;
  std::optional<double> detector_solid_angle_sr = std::nullopt;
  std::vector<std::string> references;  ///< standards: serial, certificate

  std::string organisation;
  std::string operator_name;
  std::string email;
  std::string country;
  std::string city;
  std::string street;
  std::string building;
  std::string postal_code;

  /// What else a file says, in its order and its own words.
  std::vector<std::pair<std::string, std::string>> remarks;
  friend bool operator==(const BrdfMetadata&, const BrdfMetadata&) = default;
};

}  // namespace gonio::formats
