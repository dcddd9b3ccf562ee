#include "calibration/import_reference.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/toml_reader.h"
#include "calibration/reference_csv.h"

namespace gonio::calibration {
namespace {

bool is_csv(const std::string& file) {
  constexpr std::string_view kEnding = ".csv";
  if (file.size() < kEnding.size()) return false;
  return std::equal(kEnding.begin(), kEnding.end(), file.end() - std::ssize(kEnding),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

Error wrong_parts(const ReferenceSource& source, ErrorCode code, std::string seen, std::string limit) {
  return {.code = code,
          .device = {},
          .tried = "import the reference standard",
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{source.file, 0, "shape"}};
}

bool has_shape(const ReferenceSource& source) {
  return !source.shape_text.empty() || source.shape_from != nullptr;
}

TomlPart plain_lines(const std::string& text, const std::string& file) {
  TomlPart part{.text = text.ends_with('\n') ? text : text + '\n', .came_from = {}};
  const auto lines = std::ranges::count(part.text, '\n');
  for (int line = 1; line <= lines; ++line) part.came_from.push_back({file, line, ""});
  return part;
}

bool is_zero_forty_five(const std::string& toml) {
  return toml.find("geometry = \"0/45\"") != std::string::npos;
}

Result<TomlPart> certificate_part(const ReferenceSource& source) {
  return is_csv(source.file) ? certificate_from_csv(source.text, source.file) : plain_lines(source.text, source.file);
}

Result<TomlPart> shape_part(const ReferenceSource& source, const TomlPart& certificate) {
  if (source.shape_from != nullptr) return shape_of(*source.shape_from, !is_zero_forty_five(certificate.text));
  return shape_from_csv(source.shape_text, source.shape_file);
}

// An error of the whole, where the user wrote it.
Error at_its_source(Error error, const std::vector<InputLocation>& came_from) {
  if (!error.where || error.where->line < 1 || std::cmp_greater(error.where->line, came_from.size())) return error;
  const InputLocation& source = came_from[static_cast<std::size_t>(error.where->line) - 1];
  error.where->file = source.file;
  error.where->line = source.line;
  if (!source.field.empty()) error.where->field = source.field;
  return error;
}

Result<ImportedReference> imported(std::string text, Result<ReferenceStandard> standard) {
  if (!standard) return failure(standard.error());
  ShapeReport shape = check_shape(*standard);
  return ImportedReference{std::move(text), std::move(*standard), std::move(shape)};
}

// A TOML that brings everything is kept as the user wrote it.
Result<bool> is_whole(const ReferenceSource& source) {
  if (is_csv(source.file)) return false;
  Result<TomlReader> root = TomlReader::parse(source.text, source.file);
  if (!root) return failure(root.error());
  return root->kind("shape") != TomlKind::Absent;
}

}  // namespace

Result<ImportedReference> import_reference(const ReferenceSource& source) {
  if (!source.shape_text.empty() && source.shape_from != nullptr) {
    return failure(
        wrong_parts(source, ErrorCode::InvalidInput, "a shape of its own and one of another standard", "one of them"));
  }
  const Result<bool> whole = is_whole(source);
  if (!whole) return failure(whole.error());
  if (*whole && has_shape(source)) {
    return failure(
        wrong_parts(source, ErrorCode::InvalidInput, "a [shape] in the file and another beside it", "one of them"));
  }
  if (*whole) return imported(source.text, ReferenceStandard::parse(source.text, source.file));
  if (!has_shape(source)) {
    return failure(wrong_parts(source, ErrorCode::ReferenceIncomplete, "no shape table: no white surface is Lambertian",
                               "a shape as CSV, or that of another standard"));
  }
  Result<TomlPart> toml = certificate_part(source);
  if (!toml) return failure(toml.error());
  const Result<TomlPart> shape = shape_part(source, *toml);
  if (!shape) return failure(shape.error());
  toml->text += shape->text;
  toml->came_from.insert(toml->came_from.end(), shape->came_from.begin(), shape->came_from.end());
  auto standard = ReferenceStandard::parse(toml->text, source.file);
  if (!standard) return failure(at_its_source(standard.error(), toml->came_from));
  return imported(std::move(toml->text), std::move(standard));
}

}  // namespace gonio::calibration
