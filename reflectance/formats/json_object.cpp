#include "reflectance/formats/json_object.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace gonio::formats {

using nlohmann::json;

void JsonSource::fail(std::string field, std::string seen, std::string limit) {
  if (error) return;
  error = Error{.code = ErrorCode::InvalidInput,
                .tried = "read it as " + format,
                .seen = std::move(seen),
                .limit = std::move(limit),
                .where = InputLocation{file, 0, std::move(field)}};
}

namespace {

// What some programs write for a number and JSON has not, by its name. `byte` is the last that was looked at, from 1.
std::string word_there(std::string_view text, std::size_t byte) {
  if (byte == 0) return {};
  for (const std::string_view word : {"NaN", "Infinity"})
    if (text.substr(byte - 1).starts_with(word)) return fmt::format(": {}, which is no number of JSON", word);
  return {};
}

}  // namespace

Result<json> parse_json(std::string_view text, const JsonSource& source) {
  try {
    return json::parse(text);
  } catch (const json::exception& problem) {
    // Only a parse error knows its byte; a number beyond double's range does not.
    const auto* parse_error = dynamic_cast<const json::parse_error*>(&problem);
    const std::size_t byte = parse_error == nullptr ? 0 : std::min(parse_error->byte, text.size());
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(byte);
    const auto line = 1 + std::count(text.begin(), end, '\n');
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "read it as " + source.format,
                    .seen = fmt::format("no JSON at byte {} of {}{}", byte, text.size(), word_there(text, byte)),
                    .limit = {},
                    .where = InputLocation{source.file, static_cast<int>(line), ""}});
  }
}

JsonObject::JsonObject(const json* value, std::string path, JsonSource& source)
    : value_(value), path_(std::move(path)), source_(&source) {
  if (value_ == nullptr || value_->is_object()) return;
  source_->fail(path_, value_->type_name(), "an object");
  value_ = nullptr;
}

const json* JsonObject::find(std::string_view key) const {
  if (value_ == nullptr) return nullptr;
  const auto at = value_->find(key);
  return at == value_->end() ? nullptr : &*at;
}

std::string JsonObject::path(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void JsonObject::fail(std::string_view key, std::string seen, std::string limit) const {
  source_->fail(path(key), std::move(seen), std::move(limit));
}

void JsonObject::require(std::string_view key) const {
  if (!has(key)) fail(key, "it is absent", "required");
}

bool JsonObject::is_text(std::string_view key) const {
  const json* value = find(key);
  return value != nullptr && value->is_string();
}

std::string JsonObject::text(std::string_view key, std::string_view fallback) const {
  const json* value = find(key);
  if (value == nullptr) return std::string(fallback);
  if (value->is_string()) return value->get<std::string>();
  fail(key, value->type_name(), "a text");
  return {};
}

std::optional<double> JsonObject::number(std::string_view key) const {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_number()) return value->get<double>();
  fail(key, value->type_name(), "a number");
  return std::nullopt;
}

std::size_t JsonObject::whole(std::string_view key) const {
  const json* value = find(key);
  if (value != nullptr && value->is_number_unsigned()) return value->get<std::size_t>();
  fail(key, value == nullptr ? "it is absent" : value->dump().substr(0, 40), "a whole number");
  return 0;
}

std::vector<std::string> JsonObject::texts(std::string_view key) const {
  const json* value = find(key);
  if (value == nullptr) return {};
  std::vector<std::string> found;
  if (value->is_array()) {
    for (const json& one : *value)
      if (one.is_string()) found.push_back(one.get<std::string>());
    if (found.size() == value->size()) return found;
  }
  fail(key, value->is_array() ? "another entry" : value->type_name(), "an array of texts");
  return {};
}

std::vector<std::string> JsonObject::entries(std::string_view key) const {
  const json* value = find(key);
  std::vector<std::string> found;
  if (value == nullptr) return found;
  if (!value->is_array()) fail(key, value->type_name(), "an array");
  if (value->is_array())
    for (const json& one : *value) found.push_back(one.dump(-1, ' ', true, json::error_handler_t::replace));
  return found;
}

std::vector<double> JsonObject::numbers(std::string_view key) const {
  const json* value = find(key);
  if (value == nullptr || !value->is_array()) {
    fail(key, value == nullptr ? "it is absent" : value->type_name(), "an array of numbers");
    return {};
  }
  std::vector<double> found;
  found.reserve(value->size());
  for (const json& one : *value) {
    if (!one.is_number() || !std::isfinite(one.get<double>())) {
      source_->fail(fmt::format("{}[{}]", path(key), found.size()), one.dump().substr(0, 40), "a finite number");
      return {};
    }
    found.push_back(one.get<double>());
  }
  return found;
}

JsonObject JsonObject::object(std::string_view key) const {
  return {find(key), path(key), *source_};
}

std::vector<JsonObject> JsonObject::objects(std::string_view key) const {
  const json* value = find(key);
  std::vector<JsonObject> found;
  if (value == nullptr) return found;
  if (!value->is_array()) {
    fail(key, value->type_name(), "an array of objects");
    return found;
  }
  for (const json& one : *value) found.emplace_back(&one, fmt::format("{}[{}]", path(key), found.size()), *source_);
  return found;
}

std::size_t JsonObject::choice(std::string_view key, const std::vector<std::string_view>& choices) const {
  if (!has(key)) return 0;
  const std::string said = text(key);
  const auto at = std::ranges::find(choices, said);
  if (at != choices.end()) return static_cast<std::size_t>(at - choices.begin());
  fail(key, fmt::format("'{}'", said.substr(0, 40)), fmt::format("one of {}", fmt::join(choices, ", ")));
  return 0;
}

}  // namespace gonio::formats
