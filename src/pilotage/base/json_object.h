#pragma once

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/statistics.h"

namespace pilotage {

/// Strict reading of one JSON object: each key is asked for by type, and what is missing, of another type or out of
/// range throws DataError naming the file and the path. Nothing is converted or rounded; 3.0 is an integer, 3.7 and "3"
/// are none. The reader of a file of ours calls finish(), which refuses keys that nobody asked for; in a file of
/// another program, where more keys than we read are normal, finish() is left out. The JSON must outlive the reader.
class JsonObject {
 public:
  /// `where` is what messages call the object: the file, or file and path. Throws DataError when `json` is no object.
  JsonObject(const nlohmann::ordered_json& json, std::string where);

  const std::string& where() const { return where_; }
  /// "file.path" of a key, for messages.
  std::string path(const std::string& key) const { return where_ + "." + key; }
  /// Throws DataError: what `key` holds is not what was `expected`.
  [[noreturn]] void fail(const std::string& key, const std::string& expected) const;

  bool has(const std::string& key) const;
  /// Whether the key is there and not null; it counts as asked for.
  bool has_value(const std::string& key);
  const nlohmann::ordered_json& value(const std::string& key);

  double number(const std::string& key);
  double positive_number(const std::string& key);
  /// `null` or a missing key give NaN.
  double number_or_nan(const std::string& key);
  std::int64_t integer(const std::string& key, std::int64_t min = std::numeric_limits<std::int64_t>::min(),
                       std::int64_t max = std::numeric_limits<std::int64_t>::max());
  int small_integer(const std::string& key, int min = std::numeric_limits<int>::min(),
                    int max = std::numeric_limits<int>::max()) {
    return static_cast<int>(integer(key, min, max));
  }
  bool boolean(const std::string& key);
  std::string text(const std::string& key);
  JsonObject object(const std::string& key);

  /// An array, whatever it holds.
  const nlohmann::ordered_json& list(const std::string& key);
  /// The elements of an array, each with its index in messages.
  std::vector<JsonObject> objects(const std::string& key);
  std::vector<std::string> texts(const std::string& key);
  std::vector<double> numbers(const std::string& key, std::size_t count);
  /// Any number of numbers; `null` gives NaN.
  std::vector<double> numbers_or_nan(const std::string& key);

  /// Throws DataError when the object has a key that was not asked for (keys that start with "$" are left to schema
  /// tools).
  void finish() const;

 private:
  const nlohmann::ordered_json& json_;
  std::string where_;
  std::set<std::string> asked_;
};

/// What is written to files and to standard output: `indent` blanks for each level, and a line end. Strings and keys
/// that are no UTF-8 (they hold names of files) stand there as name_as_utf8 has them.
std::string json_text(const nlohmann::ordered_json& json, int indent = 1);

/// A number for a file: NaN and infinities become null.
nlohmann::ordered_json json_number(double number);

/// "count", "of", "rate" (null of none), and "low" and "high", the ends of its interval.
nlohmann::ordered_json share_to_json(const Share& share);

}  // namespace pilotage
