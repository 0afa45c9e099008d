#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace pilotage {

/// A value inside a JSON document together with its path, so that a wrong type is reported where it stands. Reads
/// strictly: no conversion between types, no rounding, integers only where a number has no fraction. All functions
/// throw DataError. Does not own the document.
class JsonView {
 public:
  JsonView(const nlohmann::ordered_json& json, std::string where) : json_(&json), where_(std::move(where)) {}

  const nlohmann::ordered_json& json() const { return *json_; }
  const std::string& where() const { return where_; }

  /// The member `key` of an object; an error when this is no object or has no such member.
  JsonView at(const std::string& key) const;
  /// The same, nothing when the member is missing or null.
  std::optional<JsonView> find(const std::string& key) const;
  /// Element of an array.
  JsonView at(std::size_t index) const;
  /// Number of elements; an error when this is no array.
  std::size_t size() const;

  double number() const;         ///< Finite.
  double number_or_nan() const;  ///< null is NaN.
  int integer() const;
  bool boolean() const;
  std::string text() const;

  void require_object() const;
  [[noreturn]] void fail(const std::string& expectation) const;

 private:
  const nlohmann::ordered_json* json_;
  std::string where_;
};

}  // namespace pilotage
