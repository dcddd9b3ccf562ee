#include "cli/reference_files.h"

#include <fmt/format.h>

#include "base/read_file.h"

namespace gonio::cli {

Result<api::ReferenceImport> read_reference(const std::string& file, const std::string& shape_file,
                                            const std::string& shape_of, bool replace) {
  Result<std::string> text = read_file(file);
  if (!text) return failure(text.error());
  api::ReferenceImport request{.text = std::move(*text),
                               .file = file,
                               .shape = {},
                               .shape_file = shape_file,
                               .shape_of = shape_of,
                               .replace = replace};
  if (shape_file.empty()) return request;
  Result<std::string> shape = read_file(shape_file);
  if (!shape) return failure(shape.error());
  request.shape = std::move(*shape);
  return request;
}

std::string query_text(std::string_view text) {
  std::string query;
  for (const char c : text) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                          c == '_' || c == '.' || c == '~';
    query += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return query;
}

}  // namespace gonio::cli
