#include "reflectance/formats/format.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "reflectance/formats/alta_file.h"
#include "reflectance/formats/astm_file.h"
#include "reflectance/formats/bird_file.h"
#include "reflectance/formats/csv_file.h"
#include "reflectance/formats/csv_names.h"
#include "reflectance/formats/merl_file.h"
#include "reflectance/formats/nexus_file.h"
#include "reflectance/formats/rgl_file.h"
#include "reflectance/formats/ssdd_file.h"
#include "reflectance/formats/text_lines.h"
#include "reflectance/formats/utf8_text.h"
#include "reflectance/formats/zemax_file.h"

namespace gonio::formats {
namespace {

struct FormatRow {
  Format format;
  std::string_view name;
  bool is_readable;
  bool is_writable;
};
constexpr std::array kFormats{
    FormatRow{Format::Csv, "csv", true, true},      FormatRow{Format::Bird, "bird", true, true},
    FormatRow{Format::Astm, "astm", true, true},    FormatRow{Format::Zemax, "zemax", true, true},
    FormatRow{Format::Merl, "merl", true, true},    FormatRow{Format::Ssdd, "ssdd", true, true},
    FormatRow{Format::Pab, "pab", false, true},     FormatRow{Format::Alta, "alta", true, false},
    FormatRow{Format::Klems, "klems", false, true}, FormatRow{Format::Rgl, "rgl", true, true},
    FormatRow{Format::Nexus, "nexus", true, true}};

const FormatRow& row_of(Format format) {
  return kFormats.at(static_cast<std::size_t>(format));
}

constexpr std::string_view kHdf5Start = "\x89HDF\r\n\x1a\n";
constexpr std::string_view kTensorStart{"tensor_file\0", 12};
constexpr std::string_view kMerlStart{"\x5A\0\0\0\x5A\0\0\0\xB4\0\0\0", 12};  // 90, 90, 180

// Editors put it before UTF-8 text; no format knows it.
std::string_view without_byte_order_mark(std::string_view bytes) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return bytes.starts_with(kMark) ? bytes.substr(kMark.size()) : bytes;
}

bool is_utf16(std::string_view bytes) {
  return bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
}

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool has_columns_of_astm(std::string_view text) {
  constexpr std::string_view kKey = "VARS";
  const std::size_t at = text.find(kKey);
  return at != std::string_view::npos && trimmed(text.substr(at + kKey.size())).starts_with("theta_i");
}

std::optional<Format> detect_text(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(first, text.find('\n', first) - first);
  TextLines lines(text, "CSV", "");
  std::string_view names = lines.next_filled().value_or("");  // below comments
  if (is_separator_line(names)) names = lines.next_filled().value_or("");
  if (has(names, "theta_i_deg") && has(names, "f_per_sr")) return Format::Csv;
  if (text[first] == '{')
    return has(text, "\"metadata\"") && has(text, "\"BRDF\"") ? std::optional(Format::Bird) : std::nullopt;
  if (text[first] == '<') return has(text, "<WindowElement") ? std::optional(Format::Klems) : std::nullopt;
  if (line.starts_with("VERSION") && has(text, "DATA_TYPE")) return Format::Ssdd;
  if (has(text, "#PARAM_IN")) return Format::Alta;
  if (has(text, "#format: theta phi")) return Format::Pab;
  if (has(text, "ScatterRadial") && has(text, "AngleOfIncidence")) return Format::Zemax;
  if (has_columns_of_astm(text)) return Format::Astm;
  if (is_csv_header(names)) return Format::Csv;
  return std::nullopt;
}

Error unknown_format(std::string file, std::string seen) {
  std::string known;
  for (const FormatRow& row : kFormats)
    if (row.is_readable) known.append(known.empty() ? "" : ", ").append(row.name);
  return {.code = ErrorCode::InvalidInput,
          .tried = "read a BRDF",
          .seen = std::move(seen),
          .limit = known,
          .where = InputLocation{std::move(file), 1, ""}};
}

// A table has its columns named, so that whoever brought it can mend them.
std::string seen_instead(std::string_view bytes) {
  constexpr std::size_t kMost = 80;
  if (bytes.empty()) return "an empty file";
  const std::string_view first = TextLines(bytes.substr(0, kMost), "CSV", "").next_filled("").value_or("");
  const bool is_text = std::ranges::none_of(first, [](char c) { return c != '\t' && is_control(c); });
  const bool is_table = is_text && (split(first, csv_separator(first)).size() > 2 || words(first).size() > 2);
  if (!is_table) return "none of the formats that are known";
  return fmt::format(
      "none of the formats that are known; if '{}' are columns of a CSV, its first line must name theta_i_deg, "
      "phi_i_deg, theta_r_deg, phi_r_deg and f_per_sr",
      one_line(first));
}

Result<MeasuredBrdf> read_as(Format format, std::string_view bytes, const std::string& file,
                             std::optional<std::string_view> sidecar) {
  switch (format) {
    case Format::Csv:
      return read_csv(bytes, sidecar, file);
    case Format::Bird:
      return read_bird(bytes, file);
    case Format::Astm:
      return read_astm(bytes, file);
    case Format::Zemax:
      return read_zemax(bytes, file);
    case Format::Merl:
      return read_merl(bytes, file);
    case Format::Ssdd:
      return read_ssdd(bytes, file);
    case Format::Alta:
      return read_alta(bytes, file);
    case Format::Rgl:
      return read_rgl(bytes, file);
    case Format::Nexus:
      return read_nexus(bytes, file);
    case Format::Pab:
    case Format::Klems:
      break;
  }
  return failure(unknown_format(file, fmt::format("{}, which is written only", format_name(format))));
}

}  // namespace

std::string_view format_name(Format format) {
  return row_of(format).name;
}

std::optional<Format> format_from_name(std::string_view name) {
  const auto at = std::ranges::find(kFormats, name, &FormatRow::name);
  return at == kFormats.end() ? std::nullopt : std::optional(at->format);
}

bool is_readable(Format format) {
  return row_of(format).is_readable;
}

bool is_writable(Format format) {
  return row_of(format).is_writable;
}

std::optional<Format> detect_format(std::string_view bytes) {
  constexpr std::size_t kHeader = 65536;  // no header of the texts is longer; BiRD's keys may stand in any order
  bytes = without_byte_order_mark(bytes);
  if (bytes.starts_with(kHdf5Start)) return Format::Nexus;
  if (bytes.starts_with(kTensorStart)) return Format::Rgl;
  if (bytes.starts_with(kMerlStart)) return Format::Merl;
  const bool is_object = trimmed(bytes.substr(0, kHeader)).starts_with('{');
  return detect_text(is_object ? bytes : bytes.substr(0, kHeader));
}

Result<MeasuredBrdf> read_brdf(std::string_view bytes, const std::string& file,
                               std::optional<std::string_view> sidecar) {
  const std::optional<Format> format = detect_format(bytes);
  if (!format && is_utf16(bytes)) return failure(unknown_format(file, "UTF-16 text; save it as UTF-8"));
  if (!format) return failure(unknown_format(file, seen_instead(without_byte_order_mark(bytes))));
  Result<MeasuredBrdf> brdf = read_as(*format, without_byte_order_mark(bytes), file, sidecar);
  if (brdf) make_texts_utf8(*brdf);
  return brdf;
}

}  // namespace gonio::formats
