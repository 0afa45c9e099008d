#include <algorithm>
#include <array>
#include <limits>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/variant_json.h"
#include "pilotage/report/ground_json.h"
#include "pilotage/report/imagery_age_section.h"
#include "pilotage/report/report.h"
#include "pilotage/report/report_file.h"
#include "pilotage/report/report_records.h"
#include "pilotage/report/tile_fields.h"

// report.json is described once: each describe() names the keys of a record, and writing and reading follow from it.

namespace pilotage {
namespace report_records {
namespace {

using Json = nlohmann::ordered_json;

Json profile_json(const Report& report) {
  Json json;
  json["columns"] = {"distance_m", "error_m", "matchable"};
  json["rows"] = Json::array();
  for (const ErrorSample& sample : report.error_profile) {
    json["rows"].push_back(Json::array({variant_to_json(number_value(sample.distance_m)),
                                        variant_to_json(number_value(sample.error_m)), sample.matchable}));
  }
  return json;
}

Json denied_json(const Report& report) {
  Json json = Json::array();
  for (const DeniedStretch& stretch : report.denied) {
    json.push_back({{"from_distance_m", variant_to_json(number_value(stretch.from_distance_m))},
                    {"to_distance_m", variant_to_json(number_value(stretch.to_distance_m))}});
  }
  return json;
}

Json loss_json(const LossAnywhere& loss) {
  const auto number = [](double value) { return variant_to_json(number_value(value)); };
  Json json = {{"worst_distance_m", number(loss.points[loss.worst].distance_m)},
               {"worst_leg", loss.points[loss.worst].leg + 1},
               {"step_m", number(loss.step_m)},
               {"columns", {"distance_m", "max_error_m", "p_within_limit"}},
               {"rows", Json::array()}};
  for (const LossPoint& point : loss.points) {
    json["rows"].push_back(
        Json::array({number(point.distance_m), number(point.max_error_m), number(point.p_within_limit)}));
  }
  return json;
}

}  // namespace

template <class Io>
void describe(Io& io, typename Io::template Ref<GeodeticPoint> point) {
  io.degrees("lon_deg", point.lon_deg);
  io.degrees("lat_deg", point.lat_deg);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<QualityRow> row) {
  io.value("name", row.name);
  io.value("label", row.label);
  io.number("number", row.number);
  io.value("unit", row.unit);
  io.value("value", row.value);
  io.value("threshold", row.threshold);
  io.status("status", row.status, status_name);
  io.value("decides", row.decides);
  io.value("advice", row.advice);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<ReportLeg> leg) {
  io.leg("leg", leg.status.leg);
  io.item("from_item", leg.from_item);
  io.item("to_item", leg.to_item);
  io.record("from", leg.from);
  io.record("to", leg.to);
  io.number("from_distance_m", leg.from_distance_m);
  io.number("length_m", leg.status.length_m);
  io.number("matchable_fraction", leg.status.matchable_fraction);
  io.number("max_error_m", leg.status.max_error_m);
  io.value("within_limit", leg.status.within_limit);
  io.number("p_within_limit", leg.status.p_within_limit);
  io.number("p_fix", leg.status.p_fix);
  io.status("status", leg.quality, status_name);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<ReportGap> gap) {
  io.leg("leg", gap.gap.leg);
  io.record("from", gap.from);
  io.record("to", gap.to);
  io.number("from_distance_m", gap.gap.from_distance_m);
  io.number("to_distance_m", gap.gap.to_distance_m);
  io.number("length_m", gap.length_m);
  io.number("duration_s", gap.gap.duration_s);
  io.number("speed_mps", gap.speed_mps);
  io.number("error_m", gap.gap.error_m);
  io.value("within_limit", gap.gap.within_limit);
  io.number("p_first_excess", gap.gap.p_first_excess);
  io.status("status", gap.quality, status_name);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<WorstStretch> worst) {
  io.leg("leg", worst.leg);
  io.number("from_distance_m", worst.from_distance_m);
  io.number("to_distance_m", worst.to_distance_m);
  io.number("p_first_excess", worst.p_first_excess);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<ProbabilityInterval> interval) {
  io.number("low", interval.low);
  io.number("high", interval.high);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<RouteProbability> probability) {
  io.number("p_within_limit", probability.p_within_limit);
  io.number("min_p_within_limit", probability.min_p_within_limit);
  io.number("expected_fixes", probability.expected_fixes);
  io.number("expected_false_fixes", probability.expected_false_fixes);
  io.record("worst", probability.worst);
  io.record("interval", probability.interval);
  io.number("level_tiles", probability.level_tiles);
  io.number("level_age_months", probability.level_age_months);
  io.only_written("rests_on", [&] { return rests_on_text(probability); });
}

template <class Io>
void describe(Io& io, typename Io::template Ref<FixStretch> fix) {
  io.number("from_distance_m", fix.from_distance_m);
  io.number("to_distance_m", fix.to_distance_m);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<GridLevel> level) {
  io.value("level", level.matrix.level);
  io.number("gsd_m", level.gsd_m);
  io.number("min_agl_m", level.min_agl_m);
  io.number("max_agl_m", level.max_agl_m);
  io.value("tile_size_px", level.matrix.tile_size_px);
  io.value("stride_px", level.matrix.stride_px);
  io.value("search_radius_px", level.search_radius_px);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<ImageryDataset> imagery) {
  io.value("dataset", imagery.dataset);
  io.value("acquired", imagery.acquired);
  io.number("gsd_m", imagery.gsd_m);
  io.value("crs", imagery.crs);
  io.value("width_px", imagery.width_px);
  io.value("height_px", imagery.height_px);
}

template <class Io>
void describe(Io& io, typename Io::template Ref<InputFile> file) {
  io.value("role", file.role);
  io.value("name", file.name);
  io.value("date", file.date);
  io.value("digest", file.digest);
  io.any_text("licence", file.licence.terms);
  io.any_text("attribution", file.licence.attribution);
}

template <class Io>
void describe_route(Io& io, typename Io::template Ref<Report> report) {
  io.value("name", report.route_name);
  io.value("format", report.route_format);
  io.number("length_m", report.route_length_m);
  io.number("matchable_fraction", report.matchable_fraction);
  io.number("largest_error_m", report.largest_error_m);
  io.number("max_error_m", report.max_error_m);
  io.number("sigma_multiple", report.sigma_multiple);
  io.record("probability", report.probability);
  if (!report.denied.empty()) io.only_written("denied", [&] { return denied_json(report); });
  if (report.loss_anywhere) io.only_written("loss_anywhere", [&] { return loss_json(*report.loss_anywhere); });
  io.records("legs", report.legs);
  io.only_written("worst_legs", [&] {
    std::vector<int> numbers;
    for (const int index : report.worst_legs) numbers.push_back(index + 1);
    return numbers;
  });
  io.records("gaps", report.gaps);
  io.records("fixes", report.fixes);
  io.only_written("error_profile", [&] { return profile_json(report); });
}

template <class Io>
void describe_grid(Io& io, typename Io::template Ref<Report> report) {
  io.value("crs", report.crs_name);
  io.number("max_scale_distortion", report.max_scale_distortion);
  io.number("corridor_half_width_m", report.corridor_half_width_m);
  io.number("footprint_width_m", report.footprint_width_m);
  io.number("footprint_height_m", report.footprint_height_m);
  io.records("levels", report.levels);
}

/// All of the report behind its format and version.
template <class Io>
void describe(Io& io, typename Io::template Ref<Report> report) {
  io.value("software_version", report.software_version);
  io.value("title", report.title);
  io.object("verdict", [&](Io& verdict) {
    verdict.status("status", report.verdict, verdict_name);
    verdict.value("text", report.verdict_text);
    verdict.value("assumptions", report.assumptions);
  });
  io.records("quality", report.quality);
  io.object("route", [&](Io& route) { describe_route(route, report); });
  io.object("selection", [&](Io& selection) {
    selection.value("selected_tiles", report.selected_tiles);
    selection.only_written("all_tiles", [&] { return report.tiles.size(); });
    selection.value("estimated_bytes", report.estimated_bytes);
  });
  io.only_written("measures", [&] { return measures_json(report.measures); });
  io.object("grid", [&](Io& grid) { describe_grid(grid, report); });
  io.records("imagery", report.imagery);
  io.value("elevation", report.elevation);
  if (report.imagery_age) io.only_written("imagery_age", [&] { return imagery_age_json(*report.imagery_age); });
  if (report.ageing) io.only_written("ageing", [&] { return ageing_json(*report.ageing); });
  if (report.landmarks) io.only_written("landmarks", [&] { return landmark_json(*report.landmarks); });
  io.records("inputs", report.inputs);
  io.value("parameters", report.parameters);
  io.value("warnings", report.warnings);
  io.value("notes", report.notes);
  io.only_written("tiles", [&] { return tiles_json(tile_fields(report.landmarks.has_value()), report.tiles); });
}

}  // namespace report_records

namespace {

using Json = nlohmann::ordered_json;

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

std::vector<int> read_worst_legs(JsonObject route, std::size_t legs) {
  std::vector<int> worst;
  for (const Json& index : route.value("worst_legs")) {
    if (!index.is_number_integer() || index < 1 || index > legs) {
      throw DataError(route.path("worst_legs") + " names a leg that is not there: " + index.dump());
    }
    worst.push_back(index.get<int>() - 1);
  }
  return worst;
}

std::vector<ReportTile> read_tiles(JsonObject table) {
  constexpr std::array<const char*, 6> kNames = {"tile_id",        "level",    "center_lon_deg",
                                                 "center_lat_deg", "selected", "p_correct_fix"};
  const std::vector<std::string> columns = table.texts("columns");
  std::array<std::size_t, kNames.size()> at{};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto found = std::find(columns.begin(), columns.end(), kNames[i]);
    if (found == columns.end()) throw DataError(table.path("columns") + " lacks " + kNames[i]);
    at[i] = static_cast<std::size_t>(found - columns.begin());
  }
  const Json& rows = table.value("rows");
  if (!rows.is_array()) throw DataError(table.path("rows") + " is no array");
  std::vector<ReportTile> tiles;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string where = table.path("rows") + "[" + std::to_string(i) + "]";
    if (!rows[i].is_array() || rows[i].size() != columns.size()) {
      throw DataError(where + " has not one entry for each of the " + std::to_string(columns.size()) + " columns");
    }
    Json named = Json::object();  // so that types are checked as everywhere
    for (std::size_t n = 0; n < kNames.size(); ++n) named[kNames[n]] = rows[i][at[n]];
    JsonObject row(named, where);
    ReportTile& tile = tiles.emplace_back();
    tile.tile.tile_id = row.integer("tile_id");
    tile.tile.level = row.small_integer("level", 0, std::numeric_limits<int>::max());
    tile.tile.center = {row.number_or_nan("center_lon_deg"), row.number_or_nan("center_lat_deg")};
    tile.selected = row.boolean("selected");
    tile.score.p_correct_fix = row.number_or_nan("p_correct_fix");
  }
  return tiles;
}

}  // namespace

Json grid_json(const Report& report) {
  Json json;
  report_records::Writer writer(json);
  describe_grid(writer, report);
  return json;
}

namespace {

template <class Record>
Json records_json(const std::vector<Record>& records) {
  Json json;
  report_records::Writer(json).records("all", records);
  return std::move(json["all"]);
}

}  // namespace

Json levels_json(const std::vector<GridLevel>& levels) {
  return records_json(levels);
}

Json imagery_json(const std::vector<ImageryDataset>& imagery) {
  return records_json(imagery);
}

Json inputs_json(const std::vector<InputFile>& inputs) {
  return records_json(inputs);
}

Json report_json(const Report& report) {
  Json json{{"format", "pilotage-report"}, {"format_version", kReportFormatVersion}};
  report_records::Writer writer(json);
  describe(writer, report);
  return json;
}

Report report_from_json(const Json& json, const std::string& file) {
  check_format(json, file);
  Report report;
  report_records::Reader reader(JsonObject(json, file));
  describe(reader, report);
  JsonObject object(json, file);
  report.worst_legs = read_worst_legs(object.object("route"), report.legs.size());
  report.tiles = read_tiles(object.object("tiles"));
  return report;
}

Report read_report(const std::filesystem::path& path) {
  return report_from_json(parse_json(path.string(), read_file(path)), path.string());
}

}  // namespace pilotage
