#pragma once

#include <concepts>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/variant_json.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/verdict/quality.h"

// The two ways through a description of report.json (report_json.cc): a describe() that names the keys of a record is
// called with the one to write it and with the other to read it. Both have the same members; `Ref` is how each takes
// what is described. They find it by their own namespace.

namespace pilotage::report_records {

using StatusName = std::string_view (*)(QualityStatus);

/// Writes the members of a JSON object.
class Writer {
 public:
  template <class T>
  using Ref = const T&;

  explicit Writer(nlohmann::ordered_json& json) : json_(json) {}

  void number(const char* key, double value) { json_[key] = variant_to_json(number_value(value)); }
  void degrees(const char* key, double value) { json_[key] = variant_to_json(degrees_value(value)); }
  void status(const char* key, QualityStatus value, StatusName name) { json_[key] = name(value); }
  /// The number of a leg: people and files count from 1.
  void leg(const char* key, int index) { json_[key] = index + 1; }
  /// The number of an item of the plan; null for none.
  void item(const char* key, int number) {
    json_[key] = number < 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(number);
  }
  /// An integer, a text, a list of texts, true or false, or JSON.
  template <class T>
  void value(const char* key, const T& value) {
    json_[key] = value;
  }
  /// A text that stands there only where it is not empty.
  void any_text(const char* key, const std::string& value) {
    if (!value.empty()) json_[key] = value;
  }
  template <class Describe>
  void object(const char* key, Describe describe_members) {
    json_[key] = nlohmann::ordered_json::object();
    Writer members(json_[key]);
    describe_members(members);
  }
  template <class T>
  void record(const char* key, const T& value) {
    object(key, [&](Writer& members) { describe(members, value); });
  }
  template <class T>
  void record(const char* key, const std::optional<T>& value) {
    json_[key] = nullptr;
    if (value) record(key, *value);
  }
  template <class T>
  void records(const char* key, const std::vector<T>& values) {
    json_[key] = nlohmann::ordered_json::array();
    for (const T& value : values) {
      nlohmann::ordered_json& next = json_[key].emplace_back(nlohmann::ordered_json::object());
      Writer members(next);
      describe(members, value);
    }
  }
  /// What a reader does not need.
  template <class Make>
  void only_written(const char* key, Make make) {
    json_[key] = make();
  }

 private:
  nlohmann::ordered_json& json_;
};

/// Reads them. Throws DataError, naming file and key, on what is missing or of another type.
class Reader {
 public:
  template <class T>
  using Ref = T&;

  explicit Reader(JsonObject object) : object_(std::move(object)) {}

  void number(const char* key, double& value) { value = object_.number_or_nan(key); }
  void degrees(const char* key, double& value) { value = object_.number_or_nan(key); }
  void status(const char* key, QualityStatus& value, StatusName name) {
    const std::string text = object_.text(key);
    for (const QualityStatus known : {QualityStatus::kGood, QualityStatus::kMarginal, QualityStatus::kBad}) {
      if (name(known) != text) continue;
      value = known;
      return;
    }
    throw DataError(object_.path(key) + " is \"" + text.substr(0, 40) + "\", allowed are " +
                    std::string(name(QualityStatus::kGood)) + ", " + std::string(name(QualityStatus::kMarginal)) +
                    " and " + std::string(name(QualityStatus::kBad)));
  }
  void leg(const char* key, int& index) {
    index = static_cast<int>(object_.integer(key, 1, std::numeric_limits<int>::max())) - 1;
  }
  void item(const char* key, int& number) {
    number = object_.has_value(key) ? static_cast<int>(object_.integer(key, 0, std::numeric_limits<int>::max())) : -1;
  }
  template <std::integral Int>
  void value(const char* key, Int& value) {
    value = static_cast<Int>(object_.integer(key, 0, std::numeric_limits<Int>::max()));
  }
  void value(const char* key, bool& value) { value = object_.boolean(key); }
  void value(const char* key, std::string& value) { value = object_.text(key); }
  void value(const char* key, std::vector<std::string>& value) { value = object_.texts(key); }
  void value(const char* key, nlohmann::ordered_json& value) { value = object_.value(key); }
  void any_text(const char* key, std::string& value) {
    if (object_.has(key)) value = object_.text(key);
  }
  template <class Describe>
  void object(const char* key, Describe describe_members) {
    Reader members(object_.object(key));
    describe_members(members);
  }
  template <class T>
  void record(const char* key, T& value) {
    object(key, [&](Reader& members) { describe(members, value); });
  }
  template <class T>
  void record(const char* key, std::optional<T>& value) {
    if (!object_.value(key).is_null()) record(key, value.emplace());
  }
  template <class T>
  void records(const char* key, std::vector<T>& values) {
    for (JsonObject& object : object_.objects(key)) {
      Reader members(std::move(object));
      describe(members, values.emplace_back());
    }
  }
  template <class Make>
  void only_written(const char*, Make) {}

 private:
  JsonObject object_;
};

}  // namespace pilotage::report_records
