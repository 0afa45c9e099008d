#include "pilotage/camera/camera_json.h"

#include <cmath>
#include <string_view>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

const std::string kMountPrefix = "mount_";

void expect_object(const std::string& name, const Json& json) {
  if (!json.is_object()) throw DataError(name + ": expected an object, found " + std::string(json.type_name()));
}

/// A JSON value as the text form spells it: numbers as numbers, the model as a string, the coefficients blank
/// separated.
std::string text_of(const std::string& name, const std::string& key, const Json& value) {
  if (key == "distortion_model") {
    if (!value.is_string()) throw DataError(name + ": " + key + " is not a string");
    return value.get<std::string>();
  }
  if (key == "distortion") {
    std::vector<std::string> numbers;
    if (!value.is_array()) throw DataError(name + ": " + key + " is not an array");
    for (const Json& number : value) {
      if (!number.is_number()) throw DataError(name + ": " + key + " holds what is not a number");
      numbers.push_back(format_number(number.get<double>()));
    }
    return join(numbers, " ");
  }
  if (!value.is_number()) throw DataError(name + ": " + key + " is not a number");
  return format_number(value.get<double>());
}

Json number_of(const std::string& text) {
  const double number = *parse_number(text);
  // Sizes are written without a point.
  if (number == std::floor(number) && std::abs(number) < 1e15) return static_cast<std::int64_t>(number);
  return number;
}

}  // namespace

Json camera_to_json(const Camera& camera) {
  Json json = Json::object();
  for (const auto& [key, value] : camera_to_text(camera)) {
    if (key == "distortion_model") {
      json[key] = value;
    } else if (key == "distortion") {
      json[key] = camera.distortion;
    } else if (key.starts_with(kMountPrefix)) {
      json["mount"][key.substr(kMountPrefix.size())] = number_of(value);
    } else {
      json[key] = number_of(value);
    }
  }
  return json;
}

Camera camera_from_json(const std::string& name, const Json& json) {
  expect_object(name, json);
  CameraText text;
  for (const auto& [key, value] : json.items()) {
    if (key.starts_with(kMountPrefix)) throw DataError(name + ": unknown key \"" + key + "\"");
    if (key != "mount") {
      text.emplace_back(key, text_of(name, key, value));
      continue;
    }
    expect_object(name + ": mount", value);
    for (const auto& [mount_key, angle] : value.items()) {
      text.emplace_back(kMountPrefix + mount_key, text_of(name, kMountPrefix + mount_key, angle));
    }
  }
  return camera_from_text(name, text);
}

}  // namespace pilotage
