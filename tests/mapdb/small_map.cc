#include "mapdb/small_map.h"

#include <cmath>
#include <limits>

#include <GeographicLib/TransverseMercator.hpp>

#include "pilotage/base/random.h"
#include "pilotage/geo/enu_from_grid.h"
#include "pilotage/geo/geodetic_point.h"

namespace pilotage::testing {
namespace {

constexpr double kCentralMeridian_deg = 117;

GeodeticPoint geodetic_from_utm(const Eigen::Vector2d& point_m, bool north) {
  double lat = 0, lon = 0;
  GeographicLib::TransverseMercator::UTM().Reverse(kCentralMeridian_deg, point_m.x() - 500000,
                                                   point_m.y() - (north ? 0 : 10000000), lat, lon);
  return {wrap_lon_deg(lon), lat};
}

MapCrs utm_crs(bool north) {
  const std::string code = north ? "32650" : "32750";
  const std::string name = std::string("WGS 84 / UTM zone 50") + (north ? "N" : "S");
  return {
      name,
      "PROJCS[\"" + name +
          "\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
          "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],"
          "PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",117],PARAMETER[\"scale_factor\",0.9996],"
          "PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\"," +
          (north ? "0" : "10000000") +
          "],UNIT[\"metre\",1],AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH],AUTHORITY[\"EPSG\",\"" + code + "\"]]",
      "EPSG:" + code};
}

TileDescriptors make_descriptors(const MapTile& tile, const PixelWindow& window, int count, Random& random) {
  TileDescriptors result;
  result.tile_id = tile.tile_id;
  result.level = tile.level;
  result.window = window;
  for (int i = 0; i < count; ++i) {
    Feature feature;
    feature.x_px = static_cast<float>(random.below(static_cast<std::uint64_t>(window.width) * 16 + 1)) / 16;
    feature.y_px = static_cast<float>(random.below(static_cast<std::uint64_t>(window.height) * 16 + 1)) / 16;
    feature.octave = static_cast<int>(random.below(8));
    result.features.features.push_back(feature);
    result.ground_height_m.push_back(i % 4 == 3 ? std::numeric_limits<float>::quiet_NaN()
                                                : static_cast<float>(std::round(random.uniform(0, 3000)) / 10));
  }
  for (int i = 0; i < count * result.features.descriptor_bytes; ++i) {
    result.features.descriptors.push_back(static_cast<std::uint8_t>(random.below(256)));
  }
  if (tile.tile_id % 2 == 1) result.ground_height_m.clear();
  return result;
}

MapChip make_chip(const MapTile& tile, const PixelWindow& window, Random& random) {
  MapChip chip;
  chip.tile_id = tile.tile_id;
  chip.level = tile.level;
  chip.window = {window.col, window.row, 4, 3};
  chip.encoding = "gray8";
  for (int i = 0; i < 12; ++i) chip.data.push_back(static_cast<std::uint8_t>(random.below(256)));
  return chip;
}

}  // namespace

SmallMap make_small_map(const SmallMapOptions& options) {
  Random random(seed_from_name("small_map"));
  const bool north = options.northern_hemisphere;
  const auto geodetic = [north](const Eigen::Vector2d& p) { return std::optional(geodetic_from_utm(p, north)); };
  SmallMap map;
  map.header.crs = utm_crs(north);
  map.header.description = "Matching areas of a synthetic map.";
  map.header.chips = options.chips;
  map.header.tile_columns = {{"gray_variance", MapColumnType::kReal, "Gray variance V, gray levels."},
                             {"frieden_entropy", MapColumnType::kReal, "Frieden entropy H, no unit."},
                             {"rivals", MapColumnType::kInteger, "Rival peaks."},
                             {"status", MapColumnType::kText, "scored, flat or too_little_ground."}};
  std::int64_t tile_id = 0;
  for (int level = 0; level < options.levels; ++level) {
    const double gsd_m = 0.5 * std::pow(2, level);
    MapLevel map_level;
    map_level.gsd_m = gsd_m;
    map_level.min_agl_m = level == 0 ? std::numeric_limits<double>::quiet_NaN() : 60;
    map_level.max_agl_m = 240;
    TileMatrix& m = map_level.matrix;
    m.level = level;
    m.tile_size_px = m.stride_px = options.tile_size_px;
    m.grid_width_px = std::int64_t{options.columns} * options.tile_size_px;
    m.grid_height_px = std::int64_t{options.rows} * options.tile_size_px;
    m.map_from_pixel =
        GeoTransform::north_up(options.west_m, options.south_m + static_cast<double>(m.grid_height_px) * gsd_m, gsd_m);
    map.header.levels.push_back(map_level);
    for (int row = 0; row < options.rows; ++row) {
      for (int column = 0; column < options.columns; ++column, ++tile_id) {
        const PixelWindow window = m.tile_window(column, row);
        MapTile tile;
        tile.tile_id = tile_id;
        tile.level = level;
        tile.column = column;
        tile.row = row;
        const GeoTransform place =
            m.map_from_pixel.shifted(static_cast<double>(window.col), static_cast<double>(window.row));
        tile.bounds.extend(place.map_from_pixel({0, 0}));
        tile.bounds.extend(place.map_from_pixel({window.width, window.height}));
        tile.center = *geodetic(tile.bounds.center_m());
        tile.enu_from_grid = enu_from_grid(tile.bounds.center_m(), 100, geodetic);
        map.tiles.push_back(tile);
        map.values.push_back({random.uniform(0, 100), 2.71, static_cast<std::int64_t>(random.below(9)),
                              std::string(tile_id == 1 ? "flat" : "scored")});
        if (tile_id == 1) map.values.back()[0] = std::numeric_limits<double>::quiet_NaN();
        map.descriptors.push_back(make_descriptors(tile, window, options.features_per_tile, random));
        if (options.chips) map.chips.push_back(make_chip(tile, window, random));
      }
    }
  }
  const GeodeticPoint first = map.tiles.front().center;
  const GeodeticPoint last = map.tiles.back().center;
  map.route = {{1, {first, {(first.lon_deg + last.lon_deg) / 2, first.lat_deg}, last}, {std::string("field.plan")}}};
  map.legs = {{0, {map.route[0].points[0], map.route[0].points[1]}, {12.5, std::string("matchable")}},
              {1, {map.route[0].points[1], map.route[0].points[2]}, {40.0, std::string("gap")}}};
  map.info = {{"tool", "pilotage 0.1.0"}, {"camera", "{\"hfov_deg\": 73.7}"}, {"note", "höhe über grund"}};
  return map;
}

std::string write_map(const std::filesystem::path& path, const SmallMap& map, bool overwrite) {
  MapWriter writer(path, map.header, overwrite);
  for (const MapInfoEntry& entry : map.info) writer.add_info(entry.key, entry.value);
  for (std::size_t i = 0; i < map.tiles.size(); ++i) writer.add_tile(map.tiles[i], map.values[i]);
  for (const TileDescriptors& descriptors : map.descriptors) writer.add_descriptors(descriptors);
  for (const MapChip& chip : map.chips) writer.add_chip(chip);
  writer.write_route({{"name", MapColumnType::kText, "File the route was read from."}}, map.route);
  writer.write_legs({{"max_error_m", MapColumnType::kReal, "Largest predicted error, m."},
                     {"status", MapColumnType::kText, "matchable or gap."}},
                    map.legs);
  return writer.finish();
}

}  // namespace pilotage::testing
