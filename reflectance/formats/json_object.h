#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/result.h"

namespace gonio::formats {

/// Whose JSON is read: the first error sticks here, so that objects are read straight through and checked once.
struct JsonSource {
  std::string format;  ///< "BiRD JSON"
  std::string file;
  std::optional<Error> error = std::nullopt;

  void fail(std::string field, std::string seen, std::string limit = {});
};

/// Errors: InvalidInput with the line.
[[nodiscard]] Result<nlohmann::json> parse_json(std::string_view text, const JsonSource& source);

/// One object of a JSON text by its keys; what is absent gives the fallback, what has another type is an error that
/// names its path. Only for the sources that read JSON.
class JsonObject {
 public:
  /// `path` for messages. A value that is no object is an error, unless null stands for an absent one.
  JsonObject(const nlohmann::json* value, std::string path, JsonSource& source);

  [[nodiscard]] bool has(std::string_view key) const { return find(key) != nullptr; }
  [[nodiscard]] bool is_text(std::string_view key) const;
  [[nodiscard]] std::string text(std::string_view key, std::string_view fallback = {}) const;
  [[nodiscard]] std::optional<double> number(std::string_view key) const;
  [[nodiscard]] std::size_t whole(std::string_view key) const;
  [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
  /// Each entry of an array as JSON text, whatever it is; empty where the key is absent.
  [[nodiscard]] std::vector<std::string> entries(std::string_view key) const;
  [[nodiscard]] std::vector<double> numbers(std::string_view key) const;
  [[nodiscard]] JsonObject object(std::string_view key) const;
  [[nodiscard]] std::vector<JsonObject> objects(std::string_view key) const;
  /// An index into `choices`; 0 where the key is absent.
  [[nodiscard]] std::size_t choice(std::string_view key, const std::vector<std::string_view>& choices) const;

  [[nodiscard]] std::string path(std::string_view key) const;
  void require(std::string_view key) const;
  void fail(std::string_view key, std::string seen, std::string limit = {}) const;

 private:
  [[nodiscard]] const nlohmann::json* find(std::string_view key) const;
  const nlohmann::json* value_;
  std::string path_;
  JsonSource* source_;
};

}  // namespace gonio::formats
