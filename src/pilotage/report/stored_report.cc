#include "pilotage/report/stored_report.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxIndex = std::numeric_limits<int>::max();

void check_format(const Json& json, const std::string& file) {
  const auto format = json.is_object() ? json.find("format") : json.end();
  if (!json.is_object() || format == json.end() || *format != "pilotage-report") {
    throw DataError(file +
                    ": is not a report; `pilotage report --outputs json` and `pilotage prepare` write report.json");
  }
  const std::int64_t version = JsonObject(json, file).integer("format_version");
  if (version == kReportFormatVersion) return;
  const bool newer = version > kReportFormatVersion;
  throw DataError(file + ": is a report of format version " + std::to_string(version) + ", this program knows " +
                  std::to_string(kReportFormatVersion) +
                  (newer ? "; compare with the newer program" : "; write it again with `pilotage report`"));
}

GeodeticPoint point_of(JsonObject object) {
  return {object.number_or_nan("lon_deg"), object.number_or_nan("lat_deg")};
}

void read_route(JsonObject route, StoredReport& report) {
  report.route_length_m = route.number_or_nan("length_m");
  report.matchable_fraction = route.number_or_nan("matchable_fraction");
  report.largest_error_m = route.number_or_nan("largest_error_m");
  report.max_error_m = route.number_or_nan("max_error_m");
  if (!route.value("probability").is_null()) {
    JsonObject probability = route.object("probability");
    report.p_within_limit = probability.number_or_nan("p_within_limit");
    report.expected_fixes = probability.number_or_nan("expected_fixes");
    report.expected_false_fixes = probability.number_or_nan("expected_false_fixes");
  }
  for (JsonObject& leg : route.objects("legs")) {
    report.legs.push_back({leg.small_integer("leg", 0, kMaxIndex), point_of(leg.object("from")),
                           point_of(leg.object("to")), leg.text("status"), leg.number_or_nan("max_error_m"),
                           leg.number_or_nan("p_within_limit")});
  }
  const Json& worst = route.value("worst_legs");
  for (const Json& index : worst) {
    if (!index.is_number_integer() || index < 0 || index >= report.legs.size()) {
      throw DataError(route.path("worst_legs") + " names a leg that is not there: " + index.dump());
    }
    report.worst_legs.push_back(index.get<int>());
  }
  for (JsonObject& gap : route.objects("gaps")) {
    ++report.gaps;
    const double length_m = gap.number_or_nan("length_m");
    if (length_m <= report.longest_gap_m) continue;
    report.longest_gap_m = length_m;
    report.longest_gap_s = gap.number_or_nan("duration_s");
  }
}

void read_tiles(JsonObject tiles, StoredReport& report) {
  constexpr std::array<const char*, 6> kNames = {"tile_id",        "level",    "center_lon_deg",
                                                 "center_lat_deg", "selected", "p_correct_fix"};
  const std::vector<std::string> columns = tiles.texts("columns");
  std::array<std::size_t, kNames.size()> at{};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto found = std::find(columns.begin(), columns.end(), kNames[i]);
    if (found == columns.end()) throw DataError(tiles.path("columns") + " lacks " + kNames[i]);
    at[i] = static_cast<std::size_t>(found - columns.begin());
  }
  const Json& rows = tiles.value("rows");
  if (!rows.is_array()) throw DataError(tiles.path("rows") + " is no array");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string where = tiles.path("rows") + "[" + std::to_string(i) + "]";
    if (!rows[i].is_array() || rows[i].size() != columns.size()) {
      throw DataError(where + " has not one entry for each of the " + std::to_string(columns.size()) + " columns");
    }
    Json named = Json::object();  // so that types are checked as everywhere
    for (std::size_t n = 0; n < kNames.size(); ++n) named[kNames[n]] = rows[i][at[n]];
    JsonObject row(named, where);
    report.tiles.push_back({row.integer("tile_id"),
                            row.small_integer("level", 0, kMaxIndex),
                            {row.number_or_nan("center_lon_deg"), row.number_or_nan("center_lat_deg")},
                            row.boolean("selected"),
                            row.number_or_nan("p_correct_fix")});
  }
}

}  // namespace

StoredReport stored_report(const Json& json, const std::string& file) {
  check_format(json, file);
  StoredReport report;
  report.file = file;
  JsonObject object(json, file);
  report.title = object.text("title");
  report.software_version = object.text("software_version");
  JsonObject verdict = object.object("verdict");
  report.verdict_status = verdict.text("status");
  report.verdict_text = verdict.text("text");
  for (JsonObject& row : object.objects("quality")) {
    report.quality.push_back({row.text("name"), row.text("label"), row.text("value"), row.text("status")});
  }
  read_route(object.object("route"), report);
  JsonObject selection = object.object("selection");
  report.selected_tiles = selection.integer("selected_tiles");
  report.estimated_bytes = selection.integer("estimated_bytes");
  JsonObject grid = object.object("grid");
  for (JsonObject& level : grid.objects("levels")) {
    report.stride_m.push_back(level.number("gsd_m") * level.number("stride_px"));
  }
  report.grid = object.value("grid");
  read_tiles(object.object("tiles"), report);
  for (JsonObject& input : object.objects("inputs")) {
    report.inputs.push_back({input.text("role"), input.text("name"), input.text("date"), input.text("digest")});
  }
  report.parameters = object.value("parameters");
  return report;
}

StoredReport read_report(const std::filesystem::path& path) {
  return stored_report(parse_json(path.string(), read_file(path)), path.string());
}

}  // namespace pilotage
