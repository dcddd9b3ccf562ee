#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace gonio::formats {

/// As much of JSON Schema 2020-12 as the BiRD schema uses, written from the specification: type, required, properties,
/// additionalProperties, items, prefixItems, enum, const, minimum, maximum, exclusiveMaximum, oneOf, not, if/then/else,
/// $ref.
class JsonSchemas {
 public:
  /// Every file of the folder that is JSON, known by its $id.
  explicit JsonSchemas(const std::filesystem::path& folder);
  [[nodiscard]] bool is_empty() const { return by_id_.empty(); }
  /// What is wrong, each with its place; empty where the value is valid. `name` is part of the schema's $id.
  [[nodiscard]] std::vector<std::string> problems(const std::string& name, const nlohmann::json& value) const;

 private:
  using Problems = std::vector<std::string>;
  void check(const nlohmann::json& schema, const nlohmann::json& value, const std::string& at, Problems& out) const;
  void check_object(const nlohmann::json& schema, const nlohmann::json& value, const std::string& at,
                    Problems& out) const;
  void check_choices(const nlohmann::json& schema, const nlohmann::json& value, const std::string& at,
                     Problems& out) const;
  [[nodiscard]] bool is_valid(const nlohmann::json& schema, const nlohmann::json& value) const;

  std::map<std::string, nlohmann::json> by_id_;
};

}  // namespace gonio::formats
