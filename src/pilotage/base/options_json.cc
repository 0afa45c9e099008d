#include "pilotage/base/options_json.h"

#include <algorithm>
#include <set>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/variant_json.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

/// "[json.exception.parse_error.101] parse error at line 2, column 1: …" is for programmers up to the line.
std::string without_code(const std::string& message) {
  for (const std::string_view mark : {"parse error at ", "] "}) {
    const auto at = message.find(mark);
    if (at != std::string::npos) return message.substr(at + mark.size());
  }
  return message;
}

// What walks over JSON (dump(), our own readers) recurses; no file of ours nests a tenth of it.
constexpr int kMaxJsonDepth = 100;

OptionValue value_from_json(const Json& json, const std::string& where) {
  if (json.is_null()) return std::monostate{};
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_unsigned()) {
    const auto number = json.get<std::uint64_t>();
    if (number > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      throw UsageError(where + " = " + json.dump() + " is too large for an integer");
    }
    return static_cast<std::int64_t>(number);
  }
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number_float()) return json.get<double>();
  if (json.is_string()) return json.get<std::string>();
  throw UsageError(where + ": an object is not allowed here");
}

OptionValue list_from_json(const Json& json, OptionType type, const std::string& where) {
  if (type == OptionType::kNumberList) {
    std::vector<double> numbers;
    for (const auto& element : json) {
      if (!element.is_number()) throw UsageError(where + " holds " + element.dump() + ", expected numbers");
      numbers.push_back(element.get<double>());
    }
    return numbers;
  }
  std::vector<std::string> texts;
  for (const auto& element : json) {
    if (!element.is_string()) throw UsageError(where + " holds " + element.dump() + ", expected strings");
    texts.push_back(element.get<std::string>());
  }
  return texts;
}

/// Names of files may be any bytes, JSON is UTF-8: `change` is name_as_utf8 or its inverse.
template <class Change>
OptionValue with_names(const OptionField& field, OptionValue value, const Change& change) {
  if (!field.is_path) return value;
  if (auto* text = std::get_if<std::string>(&value)) *text = change(*text);
  if (auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    for (std::string& text : *texts) text = change(text);
  }
  return value;
}

std::string nearest_path(const OptionList& list, std::string_view path) {
  std::vector<std::string> paths;
  for (const auto& field : list.fields) paths.push_back(field.path);
  return nearest_word(path, paths);
}

void set_object(const OptionList& list, const Json& json, const std::string& prefix, const std::string& name) {
  for (const auto& [key, value] : json.items()) {
    if (key.starts_with("$")) continue;
    const std::string path = prefix.empty() ? key : prefix + "." + key;
    if (key.find('.') != std::string::npos) {
      throw UsageError(name + ": unknown key \"" + path + "\"; nested options are written as objects");
    }
    if (const OptionField* field = list.find(path)) {
      const bool is_list = field->type == OptionType::kStringList || field->type == OptionType::kNumberList;
      try {
        if (value.is_array() && is_list) {
          field->set(with_names(*field, list_from_json(value, field->type, path), bytes_of_name));
        } else if (value.is_array()) {
          throw UsageError(path + ": a list is not allowed here");
        } else {
          field->set(with_names(*field, value_from_json(value, path), bytes_of_name));
        }
      } catch (const UsageError& error) {
        throw UsageError(name + ": " + error.what());
      }
      continue;
    }
    const bool is_group =
        std::any_of(list.groups.begin(), list.groups.end(), [&](const auto& group) { return group.path == path; });
    if (!is_group) {
      const std::string nearest = nearest_path(list, path);
      throw UsageError(name + ": unknown key \"" + path + "\"" +
                       (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
    }
    if (!value.is_object()) throw UsageError(name + ": " + path + " is not an object");
    set_object(list, value, path, name);
  }
}

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', begin)) {
    parts.push_back(path.substr(begin, dot - begin));
    begin = dot + 1;
  }
  parts.push_back(path.substr(begin));
  return parts;
}

Json* object_at(Json& root, const std::string& group_path) {
  Json* at = &root;
  if (group_path.empty()) return at;
  for (const auto& part : split_path(group_path)) at = &(*at)["properties"][part];
  return at;
}

std::string parent_path(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

Json element_schema(const OptionField& field, const char* type) {
  Json schema = {{"type", type}};
  if (!field.choices.empty()) schema["enum"] = field.choices;
  if (field.range) {
    const auto bound = [&](double value) -> Json {
      if (field.type == OptionType::kInteger) return static_cast<std::int64_t>(value);
      return value;
    };
    schema["minimum"] = bound(field.range->min);
    schema["maximum"] = bound(field.range->max);
  }
  return schema;
}

Json field_schema(const OptionField& field) {
  Json schema;
  switch (field.type) {
    case OptionType::kBool:
      schema = {{"type", "boolean"}};
      break;
    case OptionType::kInteger:
      schema = element_schema(field, "integer");
      break;
    case OptionType::kNumber:
      schema = element_schema(field, "number");
      break;
    case OptionType::kString:
      schema = element_schema(field, "string");
      break;
    case OptionType::kStringList:
      schema = {{"type", "array"}, {"items", element_schema(field, "string")}};
      break;
    case OptionType::kNumberList:
      schema = {{"type", "array"}, {"items", element_schema(field, "number")}};
      break;
  }
  schema["description"] = field.help;
  if (!std::holds_alternative<std::monostate>(field.default_value)) {
    schema["default"] = variant_to_json(field.default_value);
  }
  return schema;
}

}  // namespace

Json parse_json(const std::string& name, std::string_view text) {
  // One set of keys for each open object; nlohmann keeps the last of a repeated key without a word.
  std::vector<std::set<std::string>> open_objects;
  std::string repeated;
  const auto watch_keys = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kMaxJsonDepth) throw DataError(name + ": nested more than " + std::to_string(kMaxJsonDepth) + " deep");
    if (event == Json::parse_event_t::object_start) open_objects.emplace_back();
    if (event == Json::parse_event_t::object_end) open_objects.pop_back();
    if (event == Json::parse_event_t::key && !open_objects.back().insert(parsed.get<std::string>()).second) {
      repeated = parsed.get<std::string>();
    }
    return true;
  };
  Json json;
  try {
    json = Json::parse(text, watch_keys);
  } catch (const Json::exception& error) {
    throw DataError(name + ": not valid JSON: " + without_code(error.what()));
  }
  if (!repeated.empty()) throw DataError(name + ": duplicate key \"" + repeated + "\" in one object");
  return json;
}

void set_options_from_json(const OptionList& list, const Json& json, const std::string& name) {
  if (!json.is_object()) throw UsageError(name + ": expected a JSON object");
  set_object(list, json, "", name);
}

Json options_to_json(const OptionList& list) {
  Json root = Json::object();
  for (const auto& field : list.fields) {
    const OptionValue value = field.get();
    if (std::holds_alternative<std::monostate>(value)) continue;
    Json* at = &root;
    for (const auto& part : split_path(field.path)) at = &(*at)[part];
    *at = variant_to_json(with_names(field, value, name_as_utf8));
  }
  return root;
}

Json options_schema(const OptionList& list, std::string_view title) {
  Json root = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
               {"title", title},
               {"type", "object"},
               {"additionalProperties", false},
               {"patternProperties", {{"^\\$", Json::object()}}},
               {"properties", Json::object()}};
  for (const auto& group : list.groups) {
    *object_at(root, group.path) = {{"type", "object"},
                                    {"description", group.help},
                                    {"additionalProperties", false},
                                    {"properties", Json::object()}};
  }
  for (const auto& field : list.fields) {
    const auto parts = split_path(field.path);
    (*object_at(root, parent_path(field.path)))["properties"][parts.back()] = field_schema(field);
  }
  return root;
}

}  // namespace pilotage
