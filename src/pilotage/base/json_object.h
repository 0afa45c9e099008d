#pragma once

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pilotage {

/// Strict reading of one JSON object of a file of ours: each key is asked for once, by type; what is missing, of
/// another type or out of range throws DataError naming the file and the path; finish() refuses keys that nobody asked
/// for. The JSON must outlive the reader.
class JsonObject {
 public:
  /// `where` is what messages call the object: the file, or file and path. Throws DataError when `json` is no object.
  JsonObject(const nlohmann::ordered_json& json, std::string where);

  bool has(const std::string& key) const { return json_.contains(key); }
  /// A finite number; `null` or a missing key give NaN.
  double number_or_nan(const std::string& key);
  double number(const std::string& key);
  std::int64_t integer(const std::string& key, std::int64_t min = std::numeric_limits<std::int64_t>::min(),
                       std::int64_t max = std::numeric_limits<std::int64_t>::max());
  int small_integer(const std::string& key, int min, int max) { return static_cast<int>(integer(key, min, max)); }
  bool boolean(const std::string& key);
  std::string text(const std::string& key);
  std::vector<std::string> texts(const std::string& key);
  const nlohmann::ordered_json& value(const std::string& key);
  JsonObject object(const std::string& key);
  /// The elements of an array, each with its index in messages.
  std::vector<JsonObject> objects(const std::string& key);
  std::vector<double> numbers(const std::string& key, std::size_t count);

  /// Throws DataError when the object has a key that was not asked for (keys that start with "$" are left to schema
  /// tools).
  void finish() const;

  /// "file: path" of a key, for messages.
  std::string path(const std::string& key) const { return where_ + "." + key; }

 private:
  const nlohmann::ordered_json& json_;
  std::string where_;
  std::set<std::string> asked_;
};

/// A number for a file: NaN and infinities become null.
nlohmann::ordered_json json_number(double number);

}  // namespace pilotage
