#include "base/toml_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#define TOML_HEADER_ONLY 0  // Debian ships the parser compiled: this file then builds in 1 s instead of 25 s
#include <toml++/toml.h>

#include "base/read_file.h"

namespace gonio {

struct TomlReader::Document {
  toml::table root;
  std::string file;
  std::optional<Error> error;
  const toml::table* lacking = nullptr;                                    ///< the table without the key of `error`
  std::map<const toml::table*, std::set<std::string, std::less<>>> asked;  ///< keys asked for, by table
  std::map<const toml::table*, std::string> paths;
};

namespace {

std::string joined(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

std::string_view kind_name(const toml::node& node) {
  if (node.is_number()) return "a number";
  if (node.is_string()) return "a text";
  if (node.is_boolean()) return "true or false";
  if (node.is_array()) return "an array";
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

std::string nearest_name(std::string_view key, const std::set<std::string, std::less<>>& known) {
  const auto nearest =
      std::ranges::min_element(known, {}, [&](const std::string& name) { return edit_distance(key, name); });
  if (nearest == known.end()) return {};
  return edit_distance(key, *nearest) <= std::max<std::size_t>(3, key.size() / 2) ? *nearest : std::string();
}

std::string range_text(const NumberRange& range) {
  const std::string unit = range.unit.empty() ? "" : " " + std::string(range.unit);
  if (std::isinf(range.most)) return fmt::format("at least {}{}", range.least, unit);
  if (std::isinf(range.least)) return fmt::format("at most {}{}", range.most, unit);
  return fmt::format("{} to {}{}", range.least, range.most, unit);
}

int line_of(const toml::node& node) {
  return static_cast<int>(node.source().begin.line);
}

// The first key, in the order of the text, that nobody asked for.
struct Stray {
  int line = std::numeric_limits<int>::max();
  std::string path;
  std::string key;
  const toml::table* table = nullptr;
};

}  // namespace

/// What the accessors share: finding a key, marking it as known, and the words of an error.
struct TomlReader::Access {
  static const toml::node* find(const TomlReader& reader, std::string_view key) {
    if (reader.table_ == nullptr) return nullptr;
    const auto* table = static_cast<const toml::table*>(reader.table_);
    reader.document_->asked[table].emplace(key);
    return table->get(key);
  }

  static const toml::node* need(TomlReader& reader, std::string_view key) {
    const toml::node* node = find(reader, key);
    if (node != nullptr) return node;
    if (!reader.has_failed()) reader.document_->lacking = static_cast<const toml::table*>(reader.table_);
    reader.fail(key, ErrorCode::MissingKey, "the key is missing");
    return nullptr;
  }

  // `only`: of this table, or of all when null.
  static Stray first_stray(const Document& document, const toml::table* only = nullptr) {
    Stray first;
    for (const auto& [table, asked] : document.asked) {
      if (only != nullptr && only != table) continue;
      for (const auto& [key, node] : *table) {
        const int line = line_of(node);
        if (asked.contains(key.str()) || line >= first.line) continue;
        const auto path = document.paths.find(table);  // the root has none
        first = Stray{line, path == document.paths.end() ? "" : path->second, std::string(key.str()), table};
      }
    }
    return first;
  }

  // A key that is missing while its table has one that is not known: most likely the same one, misspelt.
  static Error with_misspelling(const Document& document) {
    Error error = *document.error;
    if (document.lacking == nullptr) return error;
    const Stray stray = first_stray(document, document.lacking);
    if (stray.table != nullptr) error.limit = fmt::format("line {} has \"{}\": misspelt?", stray.line, stray.key);
    return error;
  }

  static void wrong_kind(TomlReader& reader, std::string_view key, const toml::node& node, std::string_view wanted) {
    reader.fail(key, ErrorCode::InvalidInput, fmt::format("found {}", kind_name(node)), std::string(wanted));
  }

  static double checked(TomlReader& reader, std::string_view key, const toml::node& node, const NumberRange& range) {
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) {
      wrong_kind(reader, key, node, "a number");
      return std::isinf(range.least) ? 0.0 : range.least;
    }
    if (!std::isfinite(*value)) {
      reader.fail(key, ErrorCode::InvalidInput, "the value is not finite", "a finite number");
    } else if (*value < range.least || *value > range.most) {
      const std::string unit = range.unit.empty() ? "" : " " + std::string(range.unit);
      reader.fail(key, ErrorCode::InvalidInput, fmt::format("value {}{}", *value, unit), range_text(range));
    }
    return *value;
  }

  static std::int64_t checked_integer(TomlReader& reader, std::string_view key, const toml::node& node,
                                      std::int64_t least, std::int64_t most) {
    const std::optional<std::int64_t> value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
    if (!value) {
      wrong_kind(reader, key, node, "a whole number");
      return least;
    }
    if (*value < least || *value > most) {
      reader.fail(key, ErrorCode::InvalidInput, fmt::format("value {}", *value), fmt::format("{} to {}", least, most));
    }
    return *value;
  }

  static std::string checked_text(TomlReader& reader, std::string_view key, const toml::node& node) {
    const auto* text = node.as_string();
    if (text == nullptr) {
      wrong_kind(reader, key, node, "a text in quotes");
      return {};
    }
    return text->get();
  }

  static TomlReader nested(const TomlReader& reader, std::string_view key, const toml::table* table) {
    const std::string path = joined(reader.path_, key);
    if (table != nullptr) {
      reader.document_->asked[table];  // known even if nothing is asked of it
      reader.document_->paths[table] = path;
    }
    return TomlReader(reader.document_, table, path);
  }
};

TomlReader::TomlReader(std::shared_ptr<Document> document, const void* table, std::string path)
    : document_(std::move(document)), table_(table), path_(std::move(path)) {}

Result<TomlReader> TomlReader::parse(std::string_view text, std::string file) {
  auto document = std::make_shared<Document>();
  try {
    document->root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "read TOML",
                    .seen = std::string(error.description()),
                    .where = InputLocation{std::move(file), static_cast<int>(error.source().begin.line), ""}});
  }
  document->file = std::move(file);
  const void* root = &document->root;
  document->asked[&document->root];
  return TomlReader(std::move(document), root, "");
}

Result<TomlReader> TomlReader::parse_file(const std::string& path) {
  const Result<std::string> text = read_file(path);
  if (!text) return failure(text.error());
  return parse(*text, path);
}

double TomlReader::number(std::string_view key, NumberRange range) {
  const toml::node* node = Access::need(*this, key);
  return node == nullptr ? 0.0 : Access::checked(*this, key, *node, range);
}

double TomlReader::number_or(std::string_view key, double fallback, NumberRange range) {
  return optional_number(key, range).value_or(fallback);
}

std::optional<double> TomlReader::optional_number(std::string_view key, NumberRange range) {
  const toml::node* node = Access::find(*this, key);
  if (node == nullptr) return std::nullopt;
  return Access::checked(*this, key, *node, range);
}

std::int64_t TomlReader::integer(std::string_view key, std::int64_t least, std::int64_t most) {
  const toml::node* node = Access::need(*this, key);
  return node == nullptr ? least : Access::checked_integer(*this, key, *node, least, most);
}

std::int64_t TomlReader::integer_or(std::string_view key, std::int64_t fallback, std::int64_t least,
                                    std::int64_t most) {
  const toml::node* node = Access::find(*this, key);
  return node == nullptr ? fallback : Access::checked_integer(*this, key, *node, least, most);
}

std::string TomlReader::text(std::string_view key) {
  const toml::node* node = Access::need(*this, key);
  return node == nullptr ? std::string() : Access::checked_text(*this, key, *node);
}

std::string TomlReader::text_or(std::string_view key, std::string_view fallback) {
  const toml::node* node = Access::find(*this, key);
  return node == nullptr ? std::string(fallback) : Access::checked_text(*this, key, *node);
}

bool TomlReader::flag_or(std::string_view key, bool fallback) {
  const toml::node* node = Access::find(*this, key);
  if (node == nullptr) return fallback;
  const auto* flag = node->as_boolean();
  if (flag == nullptr) {
    Access::wrong_kind(*this, key, *node, "true or false");
    return fallback;
  }
  return flag->get();
}

std::size_t TomlReader::choice(std::string_view key, std::span<const std::string_view> choices) {
  if (kind(key) == TomlKind::Absent) {
    fail(key, ErrorCode::MissingKey, "the key is missing", fmt::format("one of: {}", fmt::join(choices, ", ")));
    return 0;
  }
  return choice_or(key, 0, choices);
}

std::size_t TomlReader::choice_or(std::string_view key, std::size_t fallback,
                                  std::span<const std::string_view> choices) {
  const toml::node* node = Access::find(*this, key);
  if (node == nullptr) return fallback;
  const std::string word = Access::checked_text(*this, key, *node);
  const auto found = std::ranges::find(choices, word);
  if (found == choices.end()) {
    fail(key, ErrorCode::InvalidInput, fmt::format("found \"{}\"", word),
         fmt::format("one of: {}", fmt::join(choices, ", ")));
    return fallback;
  }
  return static_cast<std::size_t>(found - choices.begin());
}

std::vector<double> TomlReader::numbers(std::string_view key, NumberRange range) {
  std::vector<double> values;
  const toml::node* node = Access::need(*this, key);
  if (node == nullptr) return values;
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    Access::wrong_kind(*this, key, *node, "an array of numbers");
    return values;
  }
  if (array->empty()) fail(key, ErrorCode::InvalidInput, "the array is empty", "at least one number");
  for (const toml::node& element : *array) values.push_back(Access::checked(*this, key, element, range));
  return values;
}

std::vector<std::string> TomlReader::texts(std::string_view key) {
  std::vector<std::string> values;
  const toml::node* node = Access::need(*this, key);
  if (node == nullptr) return values;
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    Access::wrong_kind(*this, key, *node, "an array of texts");
    return values;
  }
  for (const toml::node& element : *array) values.push_back(Access::checked_text(*this, key, element));
  return values;
}

std::string TomlReader::date(std::string_view key) {
  const toml::node* node = Access::need(*this, key);
  if (node == nullptr) return {};
  const auto* date = node->as_date();
  if (date == nullptr) {
    Access::wrong_kind(*this, key, *node, "a date such as 2026-01-31, without quotes");
    return {};
  }
  const toml::date d = date->get();
  return fmt::format("{:04}-{:02}-{:02}", d.year, d.month, d.day);
}

TomlReader TomlReader::table(std::string_view key) {
  const toml::node* node = Access::need(*this, key);
  const toml::table* table = node == nullptr ? nullptr : node->as_table();
  if (node != nullptr && table == nullptr) Access::wrong_kind(*this, key, *node, "a table");
  return Access::nested(*this, key, table);
}

std::optional<TomlReader> TomlReader::optional_table(std::string_view key) {
  if (kind(key) == TomlKind::Absent) return std::nullopt;
  return table(key);
}

std::vector<TomlReader> TomlReader::tables(std::string_view key) {
  std::vector<TomlReader> readers;
  const toml::node* node = Access::find(*this, key);
  if (node == nullptr) return readers;
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    Access::wrong_kind(*this, key, *node, "an array of tables");
    return readers;
  }
  for (const toml::node& element : *array) {
    if (!element.is_table()) Access::wrong_kind(*this, key, element, "a table");
    readers.push_back(Access::nested(*this, key, element.as_table()));
  }
  return readers;
}

TomlKind TomlReader::kind(std::string_view key) {
  const toml::node* node = Access::find(*this, key);
  if (node == nullptr) return TomlKind::Absent;
  if (node->is_number()) return TomlKind::Number;
  if (node->is_string()) return TomlKind::Text;
  if (node->is_boolean()) return TomlKind::Flag;
  if (node->is_array()) return TomlKind::Array;
  if (node->is_table()) return TomlKind::Table;
  return TomlKind::Date;
}

std::vector<std::string> TomlReader::keys() const {
  std::vector<std::pair<int, std::string>> found;
  if (table_ != nullptr) {
    for (const auto& [key, node] : *static_cast<const toml::table*>(table_)) {
      found.emplace_back(line_of(node), std::string(key.str()));
    }
  }
  std::ranges::stable_sort(found, {}, &std::pair<int, std::string>::first);
  std::vector<std::string> names;
  for (auto& [line, name] : found) names.push_back(std::move(name));
  return names;
}

InputLocation TomlReader::location(std::string_view key) const {
  InputLocation where{document_->file, 0, joined(path_, key)};
  if (table_ == nullptr) return where;
  const auto* table = static_cast<const toml::table*>(table_);
  const toml::node* node = table->get(key);
  where.line = line_of(node != nullptr ? *node : static_cast<const toml::node&>(*table));
  return where;
}

const std::string& TomlReader::file() const {
  return document_->file;
}

void TomlReader::fail(std::string_view key, ErrorCode code, std::string seen, std::string limit) {
  if (document_->error) return;
  document_->error = Error{.code = code,
                           .device = {},
                           .tried = {},
                           .seen = std::move(seen),
                           .limit = std::move(limit),
                           .where = location(key)};
}

bool TomlReader::has_failed() const {
  return document_->error.has_value();
}

Result<void> TomlReader::finish() const {
  if (document_->error) return failure(Access::with_misspelling(*document_));
  const Stray first = Access::first_stray(*document_);
  if (first.table == nullptr) return {};
  const std::string nearest = nearest_name(first.key, document_->asked[first.table]);
  return failure({.code = ErrorCode::UnknownKey,
                  .tried = {},
                  .seen = fmt::format("there is no key \"{}\" here", first.key),
                  .limit = nearest.empty() ? "" : fmt::format("did you mean \"{}\"?", nearest),
                  .where = InputLocation{document_->file, first.line, joined(first.path, first.key)}});
}

}  // namespace gonio
