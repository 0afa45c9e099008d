#include "pilotage/base/json_object.h"

#include <cmath>
#include <utility>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void throw_expected(const std::string& path, const char* expected, const Json& found) {
  std::string shown = found.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (shown.size() > 60) shown = shown.substr(0, 60) + "…";
  throw DataError(path + " is " + shown + ", expected " + expected);
}

double finite_number(const Json& json, const std::string& path) {
  if (!json.is_number()) throw_expected(path, "a number", json);
  return json.get<double>();
}

std::string text_of(const Json& json, const std::string& path) {
  if (!json.is_string()) throw_expected(path, "a string", json);
  return json.get<std::string>();
}

}  // namespace

JsonObject::JsonObject(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
  if (!json.is_object()) throw_expected(where_, "an object", json);
}

const Json& JsonObject::value(const std::string& key) {
  asked_.insert(key);
  const auto found = json_.find(key);
  if (found == json_.end()) throw DataError(path(key) + " is missing");
  return *found;
}

double JsonObject::number(const std::string& key) {
  return finite_number(value(key), path(key));
}

double JsonObject::number_or_nan(const std::string& key) {
  asked_.insert(key);
  if (!json_.contains(key) || json_.at(key).is_null()) return std::numeric_limits<double>::quiet_NaN();
  return number(key);
}

std::int64_t JsonObject::integer(const std::string& key, std::int64_t min, std::int64_t max) {
  const Json& json = value(key);
  const bool too_large =
      json.is_number_unsigned() &&
      json.get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (!json.is_number_integer() || too_large) throw_expected(path(key), "an integer", json);
  const auto integer = json.get<std::int64_t>();
  if (integer < min || integer > max) {
    throw DataError(path(key) + " = " + std::to_string(integer) + " is outside [" + std::to_string(min) + ", " +
                    std::to_string(max) + "]");
  }
  return integer;
}

bool JsonObject::boolean(const std::string& key) {
  const Json& json = value(key);
  if (!json.is_boolean()) throw_expected(path(key), "true or false", json);
  return json.get<bool>();
}

std::string JsonObject::text(const std::string& key) {
  return text_of(value(key), path(key));
}

std::vector<std::string> JsonObject::texts(const std::string& key) {
  const Json& json = value(key);
  if (!json.is_array()) throw_expected(path(key), "a list of strings", json);
  std::vector<std::string> texts;
  for (const Json& element : json) texts.push_back(text_of(element, path(key)));
  return texts;
}

JsonObject JsonObject::object(const std::string& key) {
  return {value(key), path(key)};
}

std::vector<JsonObject> JsonObject::objects(const std::string& key) {
  const Json& json = value(key);
  if (!json.is_array()) throw_expected(path(key), "a list of objects", json);
  std::vector<JsonObject> objects;
  for (const Json& element : json) {
    objects.emplace_back(element, path(key) + "[" + std::to_string(objects.size()) + "]");
  }
  return objects;
}

std::vector<double> JsonObject::numbers(const std::string& key, std::size_t count) {
  const Json& json = value(key);
  if (!json.is_array() || json.size() != count) {
    throw_expected(path(key), ("a list of " + std::to_string(count) + " numbers").c_str(), json);
  }
  std::vector<double> numbers;
  for (const Json& element : json) numbers.push_back(finite_number(element, path(key)));
  return numbers;
}

void JsonObject::finish() const {
  for (const auto& [key, value] : json_.items()) {
    if (!key.starts_with("$") && !asked_.contains(key)) throw DataError(path(key) + " is not known");
  }
}

Json json_number(double number) {
  return std::isfinite(number) ? Json(number) : Json(nullptr);
}

}  // namespace pilotage
