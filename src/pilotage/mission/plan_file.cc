#include "pilotage/mission/plan_file.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utc_time.h"
#include "pilotage/base/utf8.h"
#include "pilotage/camera/camera_json.h"
#include "pilotage/mission/licence_json.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/route/route_json.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPlanVersion = 1;

Json matrix_to_json(const GridLevel& level) {
  const TileMatrix& matrix = level.matrix;
  return {{"level", matrix.level},
          {"gsd_m", level.gsd_m},
          {"min_agl_m", level.min_agl_m},
          {"max_agl_m", level.max_agl_m},
          {"search_radius_px", level.search_radius_px},
          {"point_of_origin", {matrix.map_from_pixel.origin_x, matrix.map_from_pixel.origin_y}},
          {"cell_size_m", matrix.map_from_pixel.x_per_col},
          {"grid_width_px", matrix.grid_width_px},
          {"grid_height_px", matrix.grid_height_px},
          {"tile_size_px", matrix.tile_size_px},
          {"stride_px", matrix.stride_px},
          {"matrix_width", matrix.matrix_width()},
          {"matrix_height", matrix.matrix_height()}};
}

GridLevel level_from_json(JsonObject json, int expected_level) {
  constexpr std::int64_t kMaxGrid_px = std::int64_t{1} << 28;  // tile numbers over kMaxLevels levels fit in 62 bits
  GridLevel level;
  TileMatrix& matrix = level.matrix;
  matrix.level = json.small_integer("level", expected_level, expected_level);
  level.gsd_m = json.number("gsd_m");
  level.min_agl_m = json.number("min_agl_m");
  level.max_agl_m = json.number("max_agl_m");
  level.search_radius_px = json.small_integer("search_radius_px", 1, 100000);
  const auto origin = json.numbers("point_of_origin", 2);
  const double cell_size_m = json.positive_number("cell_size_m");
  matrix.map_from_pixel = GeoTransform::north_up(origin[0], origin[1], cell_size_m);
  matrix.grid_width_px = json.integer("grid_width_px", 1, kMaxGrid_px);
  matrix.grid_height_px = json.integer("grid_height_px", 1, kMaxGrid_px);
  matrix.tile_size_px = json.small_integer("tile_size_px", 16, 8192);
  matrix.stride_px = json.small_integer("stride_px", 1, 8192);
  json.integer("matrix_width", matrix.matrix_width(), matrix.matrix_width());
  json.integer("matrix_height", matrix.matrix_height(), matrix.matrix_height());
  json.finish();
  return level;
}

Json tile_to_json(const GroundTile& tile, const RoutePlace& place) {
  Json json = {{"tile_id", tile.tile_id},
               {"level", tile.level},
               {"column", tile.column},
               {"row", tile.row},
               {"bounds_m", {tile.bounds.min_x_m, tile.bounds.min_y_m, tile.bounds.max_x_m, tile.bounds.max_y_m}},
               {"center_lon_deg", tile.center.lon_deg},
               {"center_lat_deg", tile.center.lat_deg},
               {"valid_fraction", tile.valid_fraction},
               {"route_distance_m", place.distance_m},
               {"route_offset_m", place.offset_m}};
  if (tile.map_sigma_m) json["map_sigma_m"] = *tile.map_sigma_m;
  return json;
}

struct PlacedTile {
  GroundTile tile;
  RoutePlace place;
};

PlacedTile tile_from_json(JsonObject json, const std::vector<GridLevel>& levels) {
  GroundTile tile;
  tile.tile_id = json.integer("tile_id", 0);
  tile.level = json.small_integer("level", 0, static_cast<int>(levels.size()) - 1);
  const TileMatrix& matrix = levels[static_cast<std::size_t>(tile.level)].matrix;
  tile.column = json.integer("column", 0, matrix.matrix_width() - 1);
  tile.row = json.integer("row", 0, matrix.matrix_height() - 1);
  if (tile.tile_id != tile_id_of(levels, tile.level, tile.column, tile.row)) {
    throw DataError(json.path("tile_id") + " = " + std::to_string(tile.tile_id) +
                    " does not belong to its column and row");
  }
  const auto bounds = json.numbers("bounds_m", 4);
  tile.bounds = {bounds[0], bounds[1], bounds[2], bounds[3]};
  tile.center = {json.number("center_lon_deg"), json.number("center_lat_deg")};
  tile.valid_fraction = json.number("valid_fraction");
  if (json.has("map_sigma_m")) {
    tile.map_sigma_m = json.number("map_sigma_m");
    if (!(*tile.map_sigma_m >= 0 && *tile.map_sigma_m <= 100)) {
      throw DataError(json.path("map_sigma_m") + " = " + format_number(*tile.map_sigma_m) + " is not from 0 to 100");
    }
  }
  const RoutePlace place{json.number("route_distance_m"), json.number("route_offset_m")};
  json.finish();
  return {tile, place};
}

Json sample_to_json(const FlightSample& sample) {
  return {{"lon_deg", sample.point.lon_deg},
          {"lat_deg", sample.point.lat_deg},
          {"x_m", sample.point_map_m.x()},
          {"y_m", sample.point_map_m.y()},
          {"leg", sample.leg},
          {"distance_m", sample.distance_m},
          {"azimuth_deg", sample.azimuth_deg},
          {"amsl_m", json_number(sample.amsl_m)},
          {"agl_m", sample.agl_m},
          {"speed_mps", sample.speed_mps},
          {"level", sample.level}};
}

FlightSample sample_from_json(JsonObject json, const Mission& mission) {
  FlightSample sample;
  sample.point = {json.number("lon_deg"), json.number("lat_deg")};
  sample.point_map_m = {json.number("x_m"), json.number("y_m")};
  sample.leg = json.small_integer("leg", 0, static_cast<int>(mission.flight.route.legs.size()) - 1);
  sample.distance_m = json.number("distance_m");
  sample.azimuth_deg = json.number("azimuth_deg");
  sample.amsl_m = json.number_or_nan("amsl_m");
  sample.agl_m = json.number("agl_m");
  sample.speed_mps = json.positive_number("speed_mps");
  sample.level =
      json.small_integer("level", FlightSample::kNoLevel, static_cast<int>(mission.ground.levels.size()) - 1);
  json.finish();
  return sample;
}

Json denial_to_json(const GnssDenial& denied) {
  if (denied.anywhere) return {{"anywhere", true}};
  Json json = {{"stretches", Json::array()}};
  for (const DeniedStretch& stretch : denied.stretches) {
    json["stretches"].push_back(
        {{"from_distance_m", stretch.from_distance_m}, {"to_distance_m", stretch.to_distance_m}});
  }
  for (const std::string& file : denied.files) json["files"].push_back(name_as_utf8(file));
  return json;
}

GnssDenial denial_from_json(JsonObject json) {
  GnssDenial denied;
  if (json.has("anywhere")) {
    denied.anywhere = json.boolean("anywhere");
    json.finish();
    return denied;
  }
  for (JsonObject& entry : json.objects("stretches")) {
    const DeniedStretch stretch{entry.number("from_distance_m"), entry.number("to_distance_m")};
    entry.finish();
    const double least_m = denied.stretches.empty() ? 0 : denied.stretches.back().to_distance_m;
    if (!(stretch.from_distance_m >= least_m && stretch.to_distance_m > stretch.from_distance_m)) {
      throw DataError(json.path("stretches") + ": " + format_number(stretch.from_distance_m) + " to " +
                      format_number(stretch.to_distance_m) + " m is no stretch behind " + format_number(least_m) +
                      " m");
    }
    denied.stretches.push_back(stretch);
  }
  if (denied.stretches.empty()) throw DataError(json.path("stretches") + " is empty");
  if (json.has("files")) {
    for (const std::string& file : json.texts("files")) denied.files.push_back(bytes_of_name(file));
  }
  json.finish();
  return denied;
}

std::string flight_time_from_json(JsonObject& json) {
  std::string time = json.text("flight_time");
  if (!parse_utc_date(time)) {
    throw DataError(json.path("flight_time") + " = \"" + time + "\" is no day and no moment in UTC");
  }
  return time;
}

Autopilot autopilot_from_json(JsonObject& json) {
  const std::string name = json.text("autopilot");
  for (const auto& known : enum_names(Autopilot{})) {
    if (known.name == name) return known.value;
  }
  throw DataError(json.path("autopilot") + " = \"" + name + "\" is no autopilot that is known");
}

GroundHidden ground_hidden_from_json(JsonObject json) {
  const GroundHidden hidden{json.number("fraction"), bytes_of_name(json.text("file"))};
  if (!(hidden.fraction >= 0 && hidden.fraction <= 1)) {
    throw DataError(json.path("fraction") + " = " + format_number(hidden.fraction) + " is not from 0 to 1");
  }
  json.finish();
  return hidden;
}

// A CRS that PROJ does not know is no mistake of the caller here: the file is wrong.
Crs crs_from_json(JsonObject& json) {
  const std::string name = json.text("crs_name");
  try {
    Crs crs = Crs::from_user_input(json.text("crs_wkt"));
    if (crs.name() == name) return crs;
    throw DataError(json.path("crs_name") + " = \"" + name + "\" is not the name of crs_wkt, \"" + crs.name() + "\"");
  } catch (const UsageError& error) {
    throw DataError(json.path("crs_wkt") + ": " + error.what());
  }
}

template <class Options>
Options options_of(JsonObject& json, const std::string& key) {
  Options options;
  try {
    set_options_from_json(list_options(options), json.value(key), json.path(key));
  } catch (const UsageError& error) {
    throw DataError(error.what());  // in a file of ours it is the file that is wrong
  }
  return options;
}

template <class Options>
Json json_of(Options options) {
  return options_to_json(list_options(options));
}

}  // namespace

Json plan_to_json(const Mission& mission) {
  Json json = {{"pilotage_plan", kPlanVersion},
               {"crs_name", mission.ground.crs.name()},
               {"crs_wkt", mission.ground.crs.wkt()},
               {"max_scale_distortion", mission.ground.max_scale_distortion},
               {"elevation", name_as_utf8(mission.ground.elevation)},
               {"route_file", name_as_utf8(mission.flight.route_file)},
               {"imagery_options", json_of(mission.ground.imagery.options)},
               {"camera", camera_to_json(mission.flight.camera)},
               {"ins", json_of(mission.flight.ins)},
               {"conditions", json_of(mission.flight.conditions)},
               {"max_error_m", mission.flight.max_error_m},
               {"min_agl_m", mission.flight.min_agl_m},
               {"corridor_half_width_m", mission.flight.corridor_half_width_m},
               {"footprint_width_m", mission.flight.footprint_width_m},
               {"footprint_height_m", mission.flight.footprint_height_m},
               {"warnings", mission.warnings},
               {"notes", mission.notes},
               {"imagery", Json::array()},
               {"levels", Json::array()},
               {"route", route_to_json(mission.flight.route)},
               {"route_samples", Json::array()},
               {"tiles", Json::array()}};
  if (mission.ground.elevation_sigma_m) json["elevation_sigma_m"] = *mission.ground.elevation_sigma_m;
  if (!mission.ground.elevation_datum.empty()) {
    json["elevation_datum"] = mission.ground.elevation_datum;
    json["elevation_datum_assumed"] = mission.ground.elevation_datum_assumed;
  }
  add_licence(mission.ground.elevation_licence, json, "elevation_");
  if (mission.flight.max_error_assumed) json["max_error_assumed"] = true;
  if (mission.flight.flat_ground_amsl_m) json["flat_ground_amsl_m"] = *mission.flight.flat_ground_amsl_m;
  if (!mission.flight.denied.from_start()) json["denied"] = denial_to_json(mission.flight.denied);
  if (!mission.ground.flight_time.empty()) json["flight_time"] = mission.ground.flight_time;
  for (const auto& known : enum_names(Autopilot{})) {
    if (known.value == mission.flight.autopilot) json["autopilot"] = std::string(known.name);
  }
  if (const auto& hidden = mission.flight.ground_hidden) {
    json["ground_hidden"] = {{"fraction", hidden->fraction}, {"file", name_as_utf8(hidden->file)}};
  }
  for (const ImageryDataset& image : mission.ground.imagery.datasets) {
    json["imagery"].push_back({{"dataset", name_as_utf8(image.dataset)},
                               {"gsd_m", image.gsd_m},
                               {"crs", image.crs},
                               {"acquired", image.acquired},
                               {"width_px", image.width_px},
                               {"height_px", image.height_px}});
    if (!image.map_sigma.empty()) json["imagery"].back()["map_sigma"] = name_as_utf8(image.map_sigma);
    add_licence(image.licence, json["imagery"].back());
  }
  for (const GridLevel& level : mission.ground.levels) json["levels"].push_back(matrix_to_json(level));
  for (const FlightSample& sample : mission.flight.samples) json["route_samples"].push_back(sample_to_json(sample));
  for (std::size_t i = 0; i < mission.ground.tiles.size(); ++i) {
    json["tiles"].push_back(tile_to_json(mission.ground.tiles[i], mission.flight.places.at(i)));
  }
  return json;
}

Mission plan_from_json(const Json& json, const std::string& name) {
  JsonObject object(json, name);
  Mission mission;
  if (!object.has("pilotage_plan")) {
    throw DataError(name + ": is not a tile plan; `pilotage tile` makes one of a mission file");
  }
  const std::int64_t version = object.integer("pilotage_plan", 1);
  if (version > kPlanVersion) {
    throw DataError(name + ": plan version " + std::to_string(version) + " is newer than this program reads (" +
                    std::to_string(kPlanVersion) + ")");
  }
  mission.ground.crs = crs_from_json(object);
  mission.ground.max_scale_distortion = object.number("max_scale_distortion");
  mission.ground.elevation = bytes_of_name(object.text("elevation"));
  if (object.has("elevation_sigma_m")) mission.ground.elevation_sigma_m = object.number("elevation_sigma_m");
  if (object.has("elevation_datum")) {
    mission.ground.elevation_datum = object.text("elevation_datum");
    mission.ground.elevation_datum_assumed = object.boolean("elevation_datum_assumed");
  }
  mission.ground.elevation_licence = licence_from_json(object, "elevation_");
  mission.flight.route_file = bytes_of_name(object.text("route_file"));
  mission.ground.imagery.options = options_of<ImageryOptions>(object, "imagery_options");
  mission.flight.camera = camera_from_json(object.path("camera"), object.value("camera"));
  mission.flight.ins = options_of<InsOptions>(object, "ins");
  if (object.has("conditions")) mission.flight.conditions = options_of<FlightConditions>(object, "conditions");
  mission.flight.max_error_m = object.number("max_error_m");
  mission.flight.max_error_assumed = object.has("max_error_assumed") && object.boolean("max_error_assumed");
  if (object.has("flat_ground_amsl_m")) mission.flight.flat_ground_amsl_m = object.number("flat_ground_amsl_m");
  if (object.has("denied")) mission.flight.denied = denial_from_json(object.object("denied"));
  if (object.has("flight_time")) mission.ground.flight_time = flight_time_from_json(object);
  if (object.has("autopilot")) mission.flight.autopilot = autopilot_from_json(object);
  if (object.has("ground_hidden"))
    mission.flight.ground_hidden = ground_hidden_from_json(object.object("ground_hidden"));
  mission.flight.min_agl_m = object.number("min_agl_m");
  mission.flight.corridor_half_width_m = object.number("corridor_half_width_m");
  mission.flight.footprint_width_m = object.number("footprint_width_m");
  mission.flight.footprint_height_m = object.number("footprint_height_m");
  mission.warnings = object.texts("warnings");
  mission.notes = object.texts("notes");
  for (JsonObject& image : object.objects("imagery")) {
    mission.ground.imagery.datasets.push_back(
        {bytes_of_name(image.text("dataset")), image.number("gsd_m"), image.text("crs"), image.text("acquired"),
         image.small_integer("width_px", 1, std::numeric_limits<int>::max()),
         image.small_integer("height_px", 1, std::numeric_limits<int>::max()),
         image.has("map_sigma") ? bytes_of_name(image.text("map_sigma")) : "", licence_from_json(image)});
    image.finish();
  }
  for (JsonObject& level : object.objects("levels")) {
    mission.ground.levels.push_back(level_from_json(level, static_cast<int>(mission.ground.levels.size())));
  }
  if (mission.ground.levels.empty()) throw DataError(object.path("levels") + " is empty");
  if (mission.ground.levels.size() > kMaxLevels) {
    throw DataError(object.path("levels") + " has " + std::to_string(mission.ground.levels.size()) +
                    " levels; at most " + std::to_string(kMaxLevels) + " are allowed");
  }
  mission.flight.route = route_from_json(object.value("route"), object.path("route"));
  for (JsonObject& sample : object.objects("route_samples"))
    mission.flight.samples.push_back(sample_from_json(sample, mission));
  if (mission.flight.samples.empty()) throw DataError(object.path("route_samples") + " is empty");
  for (JsonObject& tile : object.objects("tiles")) {
    const PlacedTile placed = tile_from_json(tile, mission.ground.levels);
    mission.ground.tiles.push_back(placed.tile);
    mission.flight.places.push_back(placed.place);
    if (mission.ground.tiles.size() > 1 &&
        mission.ground.tiles.back().tile_id <= mission.ground.tiles[mission.ground.tiles.size() - 2].tile_id) {
      throw DataError(object.path("tiles") + ": tile_id " + std::to_string(mission.ground.tiles.back().tile_id) +
                      " is out of order");
    }
  }
  object.finish();
  return mission;
}

Mission read_plan(const std::filesystem::path& path) {
  return plan_from_json(parse_json(path.string(), read_file(path)), path.string());
}

}  // namespace pilotage
