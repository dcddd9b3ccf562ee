#pragma once

#include <array>
#include <string>
#include <string_view>

#include "reflectance/formats/brdf_metadata.h"

namespace gonio::formats {

/// A text of the metadata, and its key in our own files.
struct MetadataText {
  std::string_view key;
  std::string BrdfMetadata::*field;
};

/// All of them but lists (references, remarks).
inline constexpr std::array kMetadataTexts{MetadataText{"id", &BrdfMetadata::id},
                                           MetadataText{"description", &BrdfMetadata::description},
                                           MetadataText{"measured_at", &BrdfMetadata::measured_at},
                                           MetadataText{"software", &BrdfMetadata::software},
                                           MetadataText{"sample", &BrdfMetadata::sample},
                                           MetadataText{"sample_kind", &BrdfMetadata::sample_kind},
                                           MetadataText{"zero_azimuth", &BrdfMetadata::zero_azimuth},
                                           MetadataText{"medium", &BrdfMetadata::medium},
                                           MetadataText{"instrument", &BrdfMetadata::instrument},
                                           MetadataText{"organisation", &BrdfMetadata::organisation},
                                           MetadataText{"operator", &BrdfMetadata::operator_name},
                                           MetadataText{"email", &BrdfMetadata::email},
                                           MetadataText{"country", &BrdfMetadata::country},
                                           MetadataText{"city", &BrdfMetadata::city},
                                           MetadataText{"street", &BrdfMetadata::street},
                                           MetadataText{"building", &BrdfMetadata::building},
                                           MetadataText{"postal_code", &BrdfMetadata::postal_code}};

}  // namespace gonio::formats
