#include "tests/reflectance/formats/json_schema.h"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace gonio::formats {

using nlohmann::json;

namespace {

bool has_type(const std::string& type, const json& value) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "number") return value.is_number();
  if (type == "integer") return value.is_number_integer();
  if (type == "boolean") return value.is_boolean();
  return type == "null" && value.is_null();
}

}  // namespace

JsonSchemas::JsonSchemas(const std::filesystem::path& folder) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    std::ifstream in(entry.path());
    const json schema = json::parse(std::string(std::istreambuf_iterator<char>(in), {}), nullptr, false);
    if (schema.is_object() && schema.contains("$id")) by_id_[schema["$id"]] = schema;
  }
}

std::vector<std::string> JsonSchemas::problems(const std::string& name, const json& value) const {
  const auto at =
      std::ranges::find_if(by_id_, [&](const auto& one) { return one.first.find(name) != std::string::npos; });
  if (at == by_id_.end()) return {"no schema " + name};
  Problems found;
  check(at->second, value, "", found);
  return found;
}

bool JsonSchemas::is_valid(const json& schema, const json& value) const {
  Problems found;
  check(schema, value, "", found);
  return found.empty();
}

void JsonSchemas::check(const json& schema, const json& value, const std::string& at, Problems& out) const {
  if (schema.is_boolean()) {
    if (!schema.get<bool>()) out.push_back(at + ": not allowed");
    return;
  }
  if (schema.contains("$ref")) {
    const auto target = by_id_.find(schema["$ref"]);
    if (target == by_id_.end()) {
      out.push_back(at + ": no schema " + schema["$ref"].dump());
    } else {
      check(target->second, value, at, out);
    }
  }
  if (schema.contains("type") && !has_type(schema["type"], value)) {
    out.push_back(at + ": not of type " + schema["type"].dump());
    return;
  }
  check_choices(schema, value, at, out);
  if (value.is_object()) check_object(schema, value, at, out);
  const json first = schema.value("prefixItems", json::array());
  for (std::size_t n = 0; value.is_array() && n < std::min(first.size(), value.size()); ++n)
    check(first[n], value[n], at + "/" + std::to_string(n), out);
  if (value.is_array() && schema.contains("items"))
    for (std::size_t n = first.size(); n < value.size(); ++n)
      check(schema["items"], value[n], at + "/" + std::to_string(n), out);
  if (!value.is_number()) return;
  const double number = value;
  if (schema.contains("minimum") && number < schema["minimum"].get<double>()) out.push_back(at + ": below minimum");
  if (schema.contains("maximum") && number > schema["maximum"].get<double>()) out.push_back(at + ": above maximum");
  if (schema.contains("exclusiveMaximum") && number >= schema["exclusiveMaximum"].get<double>())
    out.push_back(at + ": not below exclusiveMaximum");
}

void JsonSchemas::check_choices(const json& schema, const json& value, const std::string& at, Problems& out) const {
  if (schema.contains("enum") && std::ranges::count(schema["enum"], value) == 0)
    out.push_back(at + ": " + value.dump() + " is not in " + schema["enum"].dump());
  if (schema.contains("const") && schema["const"] != value) out.push_back(at + ": is not " + schema["const"].dump());
  if (schema.contains("not") && is_valid(schema["not"], value)) out.push_back(at + ": is what it must not be");
  if (schema.contains("oneOf") &&
      std::ranges::count_if(schema["oneOf"], [&](const json& one) { return is_valid(one, value); }) != 1)
    out.push_back(at + ": not exactly one of oneOf");
  if (!schema.contains("if")) return;
  const char* branch = is_valid(schema["if"], value) ? "then" : "else";
  if (schema.contains(branch)) check(schema[branch], value, at, out);
}

void JsonSchemas::check_object(const json& schema, const json& value, const std::string& at, Problems& out) const {
  if (schema.contains("required"))
    for (const json& key : schema["required"])
      if (!value.contains(key.get<std::string>())) out.push_back(at + ": no " + key.dump());
  for (const auto& [key, member] : value.items()) {
    const std::string place = at + "/" + key;
    if (schema.contains("properties") && schema["properties"].contains(key)) {
      check(schema["properties"][key], member, place, out);
    } else if (schema.contains("additionalProperties")) {
      check(schema["additionalProperties"], member, place, out);
    }
  }
}

}  // namespace gonio::formats
