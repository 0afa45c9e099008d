#pragma once

#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"

namespace pilotage::testing {

using Json = nlohmann::ordered_json;

/// Every place in a JSON document, the root first.
inline std::vector<Json::json_pointer> places_in(const Json& json,
                                                 const Json::json_pointer& here = Json::json_pointer()) {
  std::vector<Json::json_pointer> places{here};
  const auto add = [&](const Json& child, const Json::json_pointer& place) {
    for (auto& deeper : places_in(child, place)) places.push_back(std::move(deeper));
  };
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) add(value, here / key);
  } else if (json.is_array()) {
    // The first and the last stand for all elements.
    if (!json.empty()) add(json.front(), here / std::size_t{0});
    if (json.size() > 1) add(json.back(), here / (json.size() - 1));
  }
  return places;
}

/// Reads `json` with each value replaced by each of a list of others, with each key removed and with a key added to
/// each object. `reread` returns what it read as JSON again: it must throw DataError naming the file, or have taken the
/// value as it stands. An added key must be refused.
inline void expect_every_damage_refused(const Json& json, const std::function<Json(const Json&)>& reread) {
  int refused = 0;
  const auto try_reading = [&](const Json& damaged, const std::string& what, bool may_read) {
    try {
      reread(damaged);
      EXPECT_TRUE(may_read) << what << " was read";
    } catch (const DataError& error) {
      ++refused;
      EXPECT_THAT(error.what(), ::testing::HasSubstr(".json")) << what;
    } catch (const std::exception& error) {
      ADD_FAILURE() << what << ": not a DataError: " << error.what();
    }
  };
  const std::vector<Json> others{nullptr,
                                 true,
                                 -1,
                                 1.5,
                                 1e300,
                                 std::uint64_t{18446744073709551615u},
                                 "text",
                                 "",
                                 Json::array(),
                                 Json::object(),
                                 Json::array({Json::array()})};
  for (const auto& place : places_in(json)) {
    const std::string where = place.to_string();
    for (const Json& other : others) {
      Json damaged = json;
      damaged[place] = other;
      // Of another type than before: a number may stand for a number, text for text, a list for a list.
      const Json& before = json[place];
      const bool alike = (before.is_number() && other.is_number()) || before.type() == other.type() ||
                         before.is_null() || other.is_null();
      try_reading(damaged, where + " = " + other.dump(), alike);
    }
    if (json[place].is_object()) {
      Json damaged = json;
      damaged[place]["surplus"] = 1;
      try_reading(damaged, where + "/surplus", false);
    }
    if (!place.empty() && json[place.parent_pointer()].is_object()) {
      Json damaged = json;
      damaged[place.parent_pointer()].erase(place.back());
      try_reading(damaged, where + " removed", true);
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace pilotage::testing
