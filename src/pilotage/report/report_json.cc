#include "pilotage/report/report.h"
#include "pilotage/report/stored_report.h"
#include "pilotage/report/tile_fields.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const VectorValue& value) {
  return std::visit(
      [](const auto& held) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(held)>, std::monostate>)
          return nullptr;
        else
          return held;
      },
      value);
}

Json number(double value, int digits = 6) {
  return json_of(number_value(value, digits));
}

Json coordinates(GeodeticPoint point) {
  Json json;
  json["lon_deg"] = json_of(degrees_value(point.lon_deg));
  json["lat_deg"] = json_of(degrees_value(point.lat_deg));
  return json;
}

Json quality_json(const Report& report) {
  Json rows = Json::array();
  for (const QualityRow& row : report.quality) {
    Json json;
    json["name"] = row.name;
    json["label"] = row.label;
    json["number"] = number(row.number);
    json["unit"] = row.unit;
    json["value"] = row.value;
    json["threshold"] = row.threshold;
    json["status"] = status_name(row.status);
    json["decides"] = row.decides;
    json["advice"] = row.advice;
    rows.push_back(json);
  }
  return rows;
}

Json legs_json(const Report& report) {
  Json legs = Json::array();
  for (const ReportLeg& leg : report.legs) {
    Json json;
    json["leg"] = leg.status.leg;
    json["from"] = coordinates(leg.from);
    json["to"] = coordinates(leg.to);
    json["from_distance_m"] = number(leg.from_distance_m);
    json["length_m"] = number(leg.status.length_m);
    json["matchable_fraction"] = number(leg.status.matchable_fraction);
    json["max_error_m"] = number(leg.status.max_error_m);
    json["within_limit"] = leg.status.within_limit;
    json["p_within_limit"] = number(leg.status.p_within_limit);
    json["p_fix"] = number(leg.status.p_fix);
    json["status"] = status_name(leg.quality);
    legs.push_back(json);
  }
  return legs;
}

Json gaps_json(const Report& report) {
  Json gaps = Json::array();
  for (const ReportGap& gap : report.gaps) {
    Json json;
    json["leg"] = gap.gap.leg;
    json["from"] = coordinates(gap.from);
    json["to"] = coordinates(gap.to);
    json["from_distance_m"] = number(gap.gap.from_distance_m);
    json["to_distance_m"] = number(gap.gap.to_distance_m);
    json["length_m"] = number(gap.length_m);
    json["duration_s"] = number(gap.gap.duration_s);
    json["speed_mps"] = number(gap.speed_mps);
    json["error_m"] = number(gap.gap.error_m);
    json["within_limit"] = gap.gap.within_limit;
    json["p_first_excess"] = number(gap.gap.p_first_excess);
    gaps.push_back(json);
  }
  return gaps;
}

Json probability_json(const Report& report) {
  if (!report.probability) return nullptr;
  Json json;
  json["p_within_limit"] = number(report.probability->p_within_limit);
  json["min_p_within_limit"] = number(report.probability->min_p_within_limit);
  json["expected_fixes"] = number(report.probability->expected_fixes);
  json["expected_false_fixes"] = number(report.probability->expected_false_fixes);
  json["worst"] = nullptr;
  if (const auto& worst = report.probability->worst) {
    json["worst"] = {{"leg", worst->leg},
                     {"from_distance_m", number(worst->from_distance_m)},
                     {"to_distance_m", number(worst->to_distance_m)},
                     {"p_first_excess", number(worst->p_first_excess)}};
  }
  return json;
}

Json route_json(const Report& report) {
  Json json;
  json["name"] = report.route_name;
  json["format"] = report.route_format;
  json["length_m"] = number(report.route_length_m);
  json["matchable_fraction"] = number(report.matchable_fraction);
  json["largest_error_m"] = number(report.largest_error_m);
  json["max_error_m"] = number(report.max_error_m);
  json["sigma_multiple"] = number(report.sigma_multiple);
  json["probability"] = probability_json(report);
  json["legs"] = legs_json(report);
  json["worst_legs"] = report.worst_legs;
  json["gaps"] = gaps_json(report);
  json["fixes"] = Json::array();
  for (const FixStretch& fix : report.fixes) {
    Json stretch;
    stretch["from_distance_m"] = number(fix.from_distance_m);
    stretch["to_distance_m"] = number(fix.to_distance_m);
    json["fixes"].push_back(stretch);
  }
  json["error_profile"]["columns"] = {"distance_m", "error_m", "matchable"};
  json["error_profile"]["rows"] = Json::array();
  for (const ErrorSample& sample : report.error_profile) {
    json["error_profile"]["rows"].push_back(
        Json::array({number(sample.distance_m), number(sample.error_m), sample.matchable}));
  }
  return json;
}

Json measures_json(const Report& report) {
  Json measures = Json::array();
  for (const MeasureScale& scale : report.measures) {
    Json json;
    json["name"] = scale.measure.name;
    json["label"] = scale.measure.heat.title;
    json["unit"] = scale.measure.heat.unit;
    json["meaning"] = scale.measure.heat.meaning;
    json["low"] = number(scale.low, 12);
    json["high"] = number(scale.high, 12);
    json["least"] = number(scale.least, 12);
    json["most"] = number(scale.most, 12);
    measures.push_back(json);
  }
  return measures;
}

Json tiles_json(const Report& report) {
  Json json;
  json["columns"] = Json::array();
  json["labels"] = Json::array();
  json["units"] = Json::array();
  for (const TileField& field : tile_fields()) {
    json["columns"].push_back(field.name);
    json["labels"].push_back(field.label);
    json["units"].push_back(field.unit);
  }
  json["rows"] = Json::array();
  for (const ReportTile& tile : report.tiles) {
    Json row = Json::array();
    for (const TileField& field : tile_fields()) row.push_back(json_of(field.value(tile)));
    json["rows"].push_back(row);
  }
  return json;
}

Json grid_json(const Report& report) {
  Json json;
  json["crs"] = report.crs_name;
  json["max_scale_distortion"] = number(report.max_scale_distortion);
  json["corridor_half_width_m"] = number(report.corridor_half_width_m);
  json["footprint_width_m"] = number(report.footprint_width_m);
  json["footprint_height_m"] = number(report.footprint_height_m);
  json["levels"] = Json::array();
  for (const GridLevel& level : report.levels) {
    Json entry;
    entry["level"] = level.matrix.level;
    entry["gsd_m"] = number(level.gsd_m);
    entry["min_agl_m"] = number(level.min_agl_m);
    entry["max_agl_m"] = number(level.max_agl_m);
    entry["tile_size_px"] = level.matrix.tile_size_px;
    entry["stride_px"] = level.matrix.stride_px;
    entry["search_radius_px"] = level.search_radius_px;
    json["levels"].push_back(entry);
  }
  return json;
}

Json imagery_json(const Report& report) {
  Json list = Json::array();
  for (const ImageryDataset& imagery : report.imagery) {
    Json json;
    json["dataset"] = imagery.dataset;
    json["acquired"] = imagery.acquired;
    json["gsd_m"] = number(imagery.gsd_m);
    json["crs"] = imagery.crs;
    json["width_px"] = imagery.width_px;
    json["height_px"] = imagery.height_px;
    list.push_back(json);
  }
  return list;
}

Json inputs_json(const Report& report) {
  Json list = Json::array();
  for (const InputFile& file : report.inputs) {
    Json json;
    json["role"] = file.role;
    json["name"] = file.name;
    json["date"] = file.date;
    json["digest"] = file.digest;
    list.push_back(json);
  }
  return list;
}

}  // namespace

Json report_json(const Report& report) {
  Json json;
  json["format"] = "pilotage-report";
  json["format_version"] = kReportFormatVersion;
  json["software_version"] = report.software_version;
  json["title"] = report.title;
  json["verdict"]["status"] = verdict_name(report.verdict);
  json["verdict"]["text"] = report.verdict_text;
  json["quality"] = quality_json(report);
  json["route"] = route_json(report);
  json["selection"]["selected_tiles"] = report.selected_tiles;
  json["selection"]["all_tiles"] = report.tiles.size();
  json["selection"]["estimated_bytes"] = report.estimated_bytes;
  json["measures"] = measures_json(report);
  json["grid"] = grid_json(report);
  json["imagery"] = imagery_json(report);
  json["elevation"] = report.elevation;
  json["inputs"] = inputs_json(report);
  json["parameters"] = report.parameters;
  json["warnings"] = report.warnings;
  json["notes"] = report.notes;
  json["tiles"] = tiles_json(report);
  return json;
}

}  // namespace pilotage
