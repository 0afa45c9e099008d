#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/report/compare_reports.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxLines = 10;
constexpr const char* kArrow = " → ";

Json number(double value) {
  return json_number(value);
}

template <class Value>
Json both_json(const Both<Value>& values) {
  return Json::array({values[0], values[1]});
}

Json both_numbers(const Both<double>& values) {
  return Json::array({number(values[0]), number(values[1])});
}

Json point_json(GeodeticPoint point) {
  return {{"lon_deg", number(point.lon_deg)}, {"lat_deg", number(point.lat_deg)}};
}

Json areas_json(const std::vector<ComparedArea>& areas) {
  Json list = Json::array();
  for (const ComparedArea& area : areas) {
    Json ids = Json::array();
    for (const auto& id : area.tile_ids) ids.push_back(id ? Json(*id) : Json());
    list.push_back({{"level", area.level},
                    {"center", point_json(area.center)},
                    {"tile_ids", ids},
                    {"p_correct_fix", both_numbers(area.p_correct_fix)}});
  }
  return list;
}

Json entries_json(const std::vector<ComparedEntry>& entries) {
  Json list = Json::array();
  for (const ComparedEntry& entry : entries)
    list.push_back({{"name", entry.name}, {"values", both_json(entry.values)}});
  return list;
}

Json legs_json(const std::vector<ComparedLeg>& legs) {
  Json list = Json::array();
  for (const ComparedLeg& leg : legs) {
    list.push_back({{"legs", both_json(leg.legs)},
                    {"from", point_json(leg.from)},
                    {"to", point_json(leg.to)},
                    {"status", both_json(leg.statuses)},
                    {"p_within_limit", both_numbers(leg.p_within_limit)},
                    {"max_error_m", both_numbers(leg.max_error_m)},
                    {"among_worst", both_json(leg.among_worst)}});
  }
  return list;
}

// Words for people.

std::string change_text(const std::string& before, const std::string& after) {
  return before == after ? before : before + kArrow + after;
}

std::string p_text(const Both<double>& p) {
  return "P " + change_text(number_text(p[0], 2), number_text(p[1], 2));
}

std::string place_text(GeodeticPoint point) {
  return number_text(point.lat_deg, 5) + ", " + number_text(point.lon_deg, 5);
}

/// A heading and at most ten lines.
template <class Item, class Text>
std::string section(const std::string& heading, const std::vector<Item>& items, Text text) {
  if (items.empty()) return "";
  std::string result = heading + "\n";
  for (std::size_t i = 0; i < std::min(items.size(), kMaxLines); ++i) result += "  " + text(items[i]) + "\n";
  if (items.size() > kMaxLines) {
    result += "  … and " + std::to_string(items.size() - kMaxLines) + " more (--json lists all)\n";
  }
  return result;
}

std::string area_text(const ComparedArea& area) {
  const auto id_text = [&](std::size_t side) {
    return area.tile_ids[side] ? std::to_string(*area.tile_ids[side]) : std::string("none");
  };
  return "tile " + change_text(id_text(0), id_text(1)) + " at " + place_text(area.center) + ", level " +
         std::to_string(area.level) + ", " + p_text(area.p_correct_fix);
}

std::string leg_text(const ComparedLeg& leg) {
  return "leg " + change_text(std::to_string(leg.legs[0]), std::to_string(leg.legs[1])) + " from " +
         place_text(leg.from) + " to " + place_text(leg.to) + ": " + change_text(leg.statuses[0], leg.statuses[1]) +
         ", P " + change_text(number_text(leg.p_within_limit[0], 3), number_text(leg.p_within_limit[1], 3)) +
         ", error " + change_text(error_text(leg.max_error_m[0]), error_text(leg.max_error_m[1]));
}

/// "none" for what one report does not say; digests are cut to what people compare.
std::string value_text(const Json& value) {
  constexpr std::size_t kDigestLetters = 24;
  if (value.is_null()) return "none";
  if (!value.is_object()) return value.is_string() ? value.get<std::string>() : value.dump();
  std::vector<std::string> parts;
  for (const auto& [key, entry] : value.items()) {
    std::string text = entry.is_string() ? entry.get<std::string>() : entry.dump();
    if (key == "digest" && text.size() > kDigestLetters) text = text.substr(0, kDigestLetters) + "…";
    if (!text.empty()) parts.push_back(text);
  }
  return join(parts, " ");
}

std::string entry_text(const ComparedEntry& entry) {
  return entry.name + ": " + value_text(entry.values[0]) + kArrow + value_text(entry.values[1]);
}

/// Letters, not bytes: "–" is one.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool right = false) {
  const std::string blanks(width - std::min(width, width_of(text)), ' ');
  return right ? blanks + text : text + blanks;
}

std::string numbers_text(const std::vector<ComparedNumber>& numbers) {
  std::string text = padded("", 46) + padded("a", 12, true) + padded("b", 12, true) + padded("change", 12, true) + "\n";
  for (const ComparedNumber& entry : numbers) {
    const auto [before, after] = entry.values;
    const double change = after - before;
    std::string sign = change > 0 ? "+" : "";
    if (before == after || (std::isnan(before) && std::isnan(after))) sign = "=";
    const std::string unit = entry.unit.empty() ? "" : " [" + entry.unit + "]";
    text += "  " + padded(entry.label + unit, 44) + padded(number_text(before, entry.decimals), 12, true) +
            padded(number_text(after, entry.decimals), 12, true) +
            padded(sign == "=" ? sign : sign + number_text(change, entry.decimals), 12, true) + "\n";
  }
  return text;
}

std::string legs_of_one_text(const std::vector<int>& legs, const char* which) {
  if (legs.empty()) return "";
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < std::min(legs.size(), kMaxLines); ++i) numbers.push_back(std::to_string(legs[i]));
  return std::string("legs of ") + which + " only: " + join(numbers, ", ") +
         (legs.size() > kMaxLines ? " and " + std::to_string(legs.size() - kMaxLines) + " more" : "") + "\n";
}

}  // namespace

Json report_comparison_json(const ReportComparison& comparison) {
  Json json;
  json["format"] = "pilotage-report-comparison";
  json["format_version"] = 2;
  json["files"] = both_json(comparison.files);
  json["titles"] = both_json(comparison.titles);
  json["software_versions"] = both_json(comparison.software_versions);
  json["same"] = comparison.same;
  json["verdict"]["status"] = both_json(comparison.verdict_statuses);
  json["verdict"]["text"] = both_json(comparison.verdict_texts);
  json["numbers"] = Json::array();
  for (const ComparedNumber& entry : comparison.numbers) {
    json["numbers"].push_back(
        {{"name", entry.name}, {"label", entry.label}, {"unit", entry.unit}, {"values", both_numbers(entry.values)}});
  }
  json["quality"] = Json::array();
  for (const ComparedQuality& row : comparison.quality) {
    json["quality"].push_back({{"name", row.name},
                               {"label", row.label},
                               {"status", both_json(row.statuses)},
                               {"value", both_json(row.values)}});
  }
  json["legs"] = {{"common", comparison.common_legs},
                  {"changed", legs_json(comparison.legs)},
                  {"only", both_json(comparison.legs_of_one)}};
  json["areas"] = {{"kept", comparison.kept_areas},
                   {"added", areas_json(comparison.added)},
                   {"removed", areas_json(comparison.removed)},
                   {"changed", areas_json(comparison.changed)}};
  json["inputs"] = entries_json(comparison.inputs);
  json["parameters"] = entries_json(comparison.parameters);
  json["grid"] = entries_json(comparison.grid);
  json["notes"] = comparison.notes;
  return json;
}

std::string report_comparison_text(const ReportComparison& comparison) {
  std::string text;
  for (const std::size_t side : {0, 1}) {
    text += std::string(side == 0 ? "a: " : "b: ") + comparison.files[side] + "\n   " + comparison.verdict_texts[side] +
            "\n";
  }
  for (const std::string& note : comparison.notes) text += "note: " + note + "\n";
  if (comparison.same) return text + "nothing differs\n";
  text += "verdict: " + change_text(comparison.verdict_statuses[0], comparison.verdict_statuses[1]) + "\n";
  text += numbers_text(comparison.numbers);
  text += section("quality", comparison.quality, [](const ComparedQuality& row) {
    return row.label + ": " + change_text(row.statuses[0], row.statuses[1]) + " (" +
           change_text(row.values[0], row.values[1]) + ")";
  });
  text += section("legs: " + std::to_string(comparison.legs.size()) + " of " + std::to_string(comparison.common_legs) +
                      " common ones differ, the worst of b first",
                  comparison.legs, leg_text);
  text += legs_of_one_text(comparison.legs_of_one[0], "a") + legs_of_one_text(comparison.legs_of_one[1], "b");
  text += "matching areas: " + std::to_string(comparison.kept_areas) + " kept, " +
          std::to_string(comparison.added.size()) + " added, " + std::to_string(comparison.removed.size()) +
          " removed, " + std::to_string(comparison.changed.size()) + " kept with another P\n";
  text += section("added", comparison.added, area_text);
  text += section("removed", comparison.removed, area_text);
  text += section("another P", comparison.changed, area_text);
  text += section("inputs", comparison.inputs, entry_text);
  text += section("options", comparison.parameters, entry_text);
  return text + section("grid", comparison.grid, entry_text);
}

}  // namespace pilotage
