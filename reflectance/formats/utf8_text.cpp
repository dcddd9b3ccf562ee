#include "reflectance/formats/utf8_text.h"

#include <algorithm>
#include <array>

#include "reflectance/formats/metadata_texts.h"

namespace gonio::formats {
namespace {

// What a sequence's first byte asks of the second; the others are 80 to BF (RFC 3629, section 4).
struct Utf8Form {
  unsigned char first_low;
  unsigned char first_high;
  std::size_t length;
  unsigned char second_low;
  unsigned char second_high;
};
constexpr std::array kUtf8Forms{
    Utf8Form{0x00, 0x7F, 1, 0, 0},       Utf8Form{0xC2, 0xDF, 2, 0x80, 0xBF}, Utf8Form{0xE0, 0xE0, 3, 0xA0, 0xBF},
    Utf8Form{0xE1, 0xEC, 3, 0x80, 0xBF}, Utf8Form{0xED, 0xED, 3, 0x80, 0x9F}, Utf8Form{0xEE, 0xEF, 3, 0x80, 0xBF},
    Utf8Form{0xF0, 0xF0, 4, 0x90, 0xBF}, Utf8Form{0xF1, 0xF3, 4, 0x80, 0xBF}, Utf8Form{0xF4, 0xF4, 4, 0x80, 0x8F}};

unsigned char byte_at(std::string_view text, std::size_t n) {
  return static_cast<unsigned char>(text[n]);
}

// Of the character at the front of `text`, which is not empty; 0 when it is none.
std::size_t character_length(std::string_view text) {
  const unsigned char first = byte_at(text, 0);
  const auto form = std::ranges::find_if(
      kUtf8Forms, [&](const Utf8Form& f) { return first >= f.first_low && first <= f.first_high; });
  if (form == kUtf8Forms.end() || text.size() < form->length) return 0;
  for (std::size_t n = 1; n < form->length; ++n) {
    const unsigned char low = n == 1 ? form->second_low : 0x80;
    const unsigned char high = n == 1 ? form->second_high : 0xBF;
    if (byte_at(text, n) < low || byte_at(text, n) > high) return 0;
  }
  return form->length;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string as_utf8(std::string_view text) {
  if (is_utf8(text)) return std::string(text);
  std::string utf8;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const unsigned char byte = byte_at(text, n);
    if (byte < 0x80) {
      utf8 += static_cast<char>(byte);
    } else {
      utf8 += static_cast<char>(0xC0U | byte >> 6U);
      utf8 += static_cast<char>(0x80U | (byte & 0x3FU));
    }
  }
  return utf8;
}

void make_texts_utf8(MeasuredBrdf& brdf) {
  const auto make = [](std::string& text) { text = as_utf8(text); };
  for (const MetadataText& text : kMetadataTexts) make(brdf.metadata.*text.field);
  for (std::string& reference : brdf.metadata.references) make(reference);
  for (auto& [key, text] : brdf.metadata.remarks) {
    make(key);
    make(text);
  }
  for (Channel& channel : brdf.channels) make(channel.name);
  for (std::string& name : brdf.flag_names) make(name);
}

}  // namespace gonio::formats
