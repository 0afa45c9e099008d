#include "pilotage/base/json_object.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/utf8.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxExactInteger = 9007199254740992;  // 2^53: above it a double no longer tells integers apart

[[noreturn]] void throw_expected(const std::string& path, const std::string& expected, const Json& found) {
  std::string shown = found.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (shown.size() > 60) shown = shown.substr(0, 60) + "…";
  throw DataError(path + " is " + shown + ", expected " + expected);
}

std::string element_path(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

std::string as_utf8(const std::string& text) {
  return valid_utf8(text) == text ? text : name_as_utf8(text);
}

Json with_utf8_names(const Json& json) {
  if (json.is_string()) return as_utf8(json.get_ref<const std::string&>());
  if (!json.is_structured()) return json;
  Json copy = json.is_array() ? Json::array() : Json::object();
  for (const auto& item : json.items()) {
    if (json.is_array()) {
      copy.push_back(with_utf8_names(item.value()));
    } else {
      copy[as_utf8(item.key())] = with_utf8_names(item.value());
    }
  }
  return copy;
}

double number_of(const Json& json, const std::string& path) {
  if (!json.is_number()) throw_expected(path, "a number", json);
  const auto number = json.get<double>();
  if (!std::isfinite(number)) throw_expected(path, "a finite number", json);
  return number;
}

std::int64_t integer_of(const Json& json, const std::string& path) {
  if (json.is_number_unsigned()) {
    const auto number = json.get<std::uint64_t>();
    if (number <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return static_cast<std::int64_t>(number);
    }
  } else if (json.is_number_integer()) {
    return json.get<std::int64_t>();
  } else if (json.is_number_float()) {
    const auto number = json.get<double>();
    if (number == std::floor(number) && std::abs(number) <= kMaxExactInteger) return static_cast<std::int64_t>(number);
  }
  throw_expected(path, "an integer", json);
}

std::string text_of(const Json& json, const std::string& path) {
  if (!json.is_string()) throw_expected(path, "a string", json);
  return json.get<std::string>();
}

}  // namespace

JsonObject::JsonObject(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
  if (!json.is_object()) throw_expected(where_, "an object", json);
}

void JsonObject::fail(const std::string& key, const std::string& expected) const {
  throw_expected(path(key), expected, json_.at(key));
}

bool JsonObject::has(const std::string& key) const {
  return json_.contains(key);
}

bool JsonObject::has_value(const std::string& key) {
  asked_.insert(key);
  const auto found = json_.find(key);
  return found != json_.end() && !found->is_null();
}

const Json& JsonObject::value(const std::string& key) {
  asked_.insert(key);
  const auto found = json_.find(key);
  if (found == json_.end()) throw DataError(path(key) + " is missing");
  return *found;
}

double JsonObject::number(const std::string& key) {
  return number_of(value(key), path(key));
}

double JsonObject::positive_number(const std::string& key) {
  const double positive = number(key);
  if (!(positive > 0)) fail(key, "a number above 0");
  return positive;
}

double JsonObject::number_or_nan(const std::string& key) {
  return has_value(key) ? number(key) : kNaN;
}

std::int64_t JsonObject::integer(const std::string& key, std::int64_t min, std::int64_t max) {
  const std::int64_t integer = integer_of(value(key), path(key));
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

JsonObject JsonObject::object(const std::string& key) {
  return {value(key), path(key)};
}

const Json& JsonObject::list(const std::string& key) {
  const Json& json = value(key);
  if (!json.is_array()) throw_expected(path(key), "a list", json);
  return json;
}

std::vector<JsonObject> JsonObject::objects(const std::string& key) {
  std::vector<JsonObject> objects;
  for (const Json& element : list(key)) objects.emplace_back(element, element_path(path(key), objects.size()));
  return objects;
}

std::vector<std::string> JsonObject::texts(const std::string& key) {
  std::vector<std::string> texts;
  for (const Json& element : list(key)) texts.push_back(text_of(element, element_path(path(key), texts.size())));
  return texts;
}

std::vector<double> JsonObject::numbers(const std::string& key, std::size_t count) {
  if (list(key).size() != count) fail(key, "a list of " + std::to_string(count) + " numbers");
  std::vector<double> numbers;
  for (const Json& element : list(key)) numbers.push_back(number_of(element, element_path(path(key), numbers.size())));
  return numbers;
}

std::vector<double> JsonObject::numbers_or_nan(const std::string& key) {
  std::vector<double> numbers;
  for (const Json& element : list(key)) {
    numbers.push_back(element.is_null() ? kNaN : number_of(element, element_path(path(key), numbers.size())));
  }
  return numbers;
}

void JsonObject::finish() const {
  for (const auto& [key, value] : json_.items()) {
    if (!key.starts_with("$") && !asked_.contains(key)) throw DataError(path(key) + " is not known");
  }
}

std::string json_text(const Json& json, int indent) {
  try {
    return json.dump(indent) + "\n";
  } catch (const Json::type_error&) {  // a string is no UTF-8
    return with_utf8_names(json).dump(indent) + "\n";
  }
}

Json json_number(double number) {
  return std::isfinite(number) ? Json(number) : Json(nullptr);
}

Json share_to_json(const Share& share) {
  const Interval interval = share.interval();
  return {{"count", share.count},
          {"of", share.of},
          {"rate", json_number(share.value())},
          {"low", interval.low},
          {"high", interval.high}};
}

}  // namespace pilotage
