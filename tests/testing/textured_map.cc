#include "testing/textured_map.h"

#include <numbers>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/options.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_text.h"
#include "pilotage/geo/enu_from_grid.h"
#include "pilotage/mapdb/map_writer.h"

namespace pilotage::testing {
namespace {

constexpr int kTilePx = 128;
constexpr double kGsd_m = 0.5;
constexpr double kWest_m = 380000;
constexpr double kNorth_m = 6440192;

/// Noise of two scales, the coarser one the stronger.
cv::Mat texture(int size_px) {
  Random random(seed_from_name("texture"));
  const auto noise = [&](double sigma_px) {
    cv::Mat white(size_px, size_px, CV_32F);
    for (int row = 0; row < size_px; ++row) {
      for (int col = 0; col < size_px; ++col) white.at<float>(row, col) = static_cast<float>(random.normal());
    }
    cv::Mat smooth;
    cv::GaussianBlur(white, smooth, {}, sigma_px);
    return cv::Mat(smooth * (2 * sigma_px * std::sqrt(std::numbers::pi)));  // unit variance again
  };
  cv::Mat gray;
  cv::Mat(128 + 30 * noise(3) + 20 * noise(1)).convertTo(gray, CV_8U);
  return gray;
}

MapLevel level_of(const TexturedGround& ground) {
  MapLevel level;
  level.gsd_m = kGsd_m;
  level.min_agl_m = ground.agl_m * 0.7;
  level.max_agl_m = ground.agl_m * 1.4;
  TileMatrix& matrix = level.matrix;
  matrix.map_from_pixel = ground.gray.map_from_pixel;
  matrix.grid_width_px = matrix.grid_height_px = ground.gray.width_px;
  matrix.tile_size_px = matrix.stride_px = kTilePx;
  return level;
}

MapTile tile_of(const TileMatrix& matrix, int column, int row, int tiles, const Crs& crs) {
  const CrsTransform transform(crs);
  const PixelWindow window = matrix.tile_window(column, row);
  MapTile tile;
  tile.tile_id = row * tiles + column;
  tile.column = column;
  tile.row = row;
  const Eigen::Vector2d corner(static_cast<double>(window.col), static_cast<double>(window.row));
  tile.bounds.extend(matrix.map_from_pixel.map_from_pixel(corner));
  tile.bounds.extend(matrix.map_from_pixel.map_from_pixel(corner + Eigen::Vector2d(window.width, window.height)));
  tile.center = *transform.geodetic_from_map(tile.bounds.center_m());
  tile.enu_from_grid = enu_from_grid(tile.bounds.center_m(), 100,
                                     [&](const Eigen::Vector2d& point) { return transform.geodetic_from_map(point); });
  return tile;
}

/// The features that lie in the tile, relative to it.
TileDescriptors descriptors_of(const TexturedGround& ground, const MapTile& tile, const PixelWindow& window,
                               const FeatureSet& all) {
  const GroundPlace place = ground_place(ground.crs, ground.gray.map_from_pixel,
                                         Eigen::Vector2d::Constant(static_cast<double>(ground.gray.width_px) / 2));
  const Eigen::Matrix2d enu_from_pixel_m = place.pixel_from_enu_m.inverse();
  TileDescriptors stored;
  stored.tile_id = tile.tile_id;
  stored.window = window;
  stored.features.descriptor_bytes = all.descriptor_bytes;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Feature feature = all.features[i];
    feature.x_px -= static_cast<float>(window.col);
    feature.y_px -= static_cast<float>(window.row);
    const bool inside = feature.x_px >= 0 && feature.x_px < static_cast<float>(window.width) && feature.y_px >= 0 &&
                        feature.y_px < static_cast<float>(window.height);
    if (!inside) continue;
    stored.features.features.push_back(feature);
    stored.features.descriptors.insert(stored.features.descriptors.end(), all.descriptor(i),
                                       all.descriptor(i) + all.descriptor_bytes);
    if (!ground.height_m) continue;
    const Eigen::Vector2d place_px(static_cast<double>(all.features[i].x_px),
                                   static_cast<double>(all.features[i].y_px));
    stored.ground_height_m.push_back(
        static_cast<float>(ground.height_m(enu_from_pixel_m * (place_px - place.nadir_px))));
  }
  return stored;
}

MapChip chip_of(const MapTile& tile, const PixelWindow& window, const GraySource& gray) {
  const cv::Mat pixels = gray.read(window).pixels.clone();
  return {tile.tile_id, 0, window, "gray8", std::vector<std::uint8_t>(pixels.datastart, pixels.dataend)};
}

}  // namespace

TexturedGround make_textured_ground(int tiles) {
  const int size_px = tiles * kTilePx;
  TexturedGround ground;
  ground.tiles = tiles;
  Raster raster{texture(size_px), cv::Mat(size_px, size_px, CV_8U, cv::Scalar(255)),
                GeoTransform::north_up(kWest_m, kNorth_m, kGsd_m)};
  ground.gray = gray_source_from(raster);
  ground.crs = Crs::from_user_input("EPSG:32750");
  ground.center =
      geodetic_from_pixel(CrsTransform(ground.crs), raster.map_from_pixel, Eigen::Vector2d::Constant(size_px / 2.0));
  ground.camera = {160, 120, 140, 140, 80, 60};
  ground.agl_m = 60;
  return ground;
}

void write_textured_map(const std::filesystem::path& path, const TexturedGround& ground,
                        const FeatureOptions& options) {
  MapHeader header;
  header.crs = {ground.crs.name(), ground.crs.wkt(), ground.crs.authority()};
  header.description = "A map of random texture.";
  header.chips = true;
  header.landmarks = ground.landmarks.has_value();
  if (ground.map_sigma_m) header.tile_columns.push_back({"map_sigma_m", MapColumnType::kReal, "Error of the map [m]"});
  header.levels = {level_of(ground)};
  const TileMatrix matrix = header.levels.front().matrix;
  MapWriter writer(path, header, true);
  if (ground.elevation_sigma_m) writer.add_info("elevation_sigma_m", format_number(*ground.elevation_sigma_m));
  for (const auto& [key, value] : camera_to_text(ground.camera)) writer.add_info("camera." + key, value);
  FeatureOptions copy = options;
  for (const OptionField& field : list_options(copy).fields) {
    writer.add_info("features." + field.path, option_to_text(field.get()));
  }
  const int size_px = static_cast<int>(ground.gray.width_px);
  const FeatureSet all = extract_features_of_map(ground.gray, {{0, 0, size_px, size_px}}, options, 1);
  std::vector<MapTile> tiles;
  const int stored = ground.only_first_tile ? 1 : ground.tiles * ground.tiles;
  for (int id = 0; id < stored; ++id) {
    tiles.push_back(tile_of(matrix, id % ground.tiles, id / ground.tiles, ground.tiles, ground.crs));
    writer.add_tile(tiles.back(),
                    ground.map_sigma_m ? std::vector<MapValue>{*ground.map_sigma_m} : std::vector<MapValue>{});
  }
  for (const MapTile& tile : tiles) {
    writer.add_descriptors(descriptors_of(ground, tile, matrix.tile_window(tile.column, tile.row), all));
  }
  for (const MapTile& tile : tiles) {
    writer.add_chip(chip_of(tile, matrix.tile_window(tile.column, tile.row), ground.gray));
  }
  if (ground.landmarks) writer.write_landmarks(*ground.landmarks);
  writer.finish();
}

TerrainHeights terrain_below(const TexturedGround& ground, const Eigen::Vector2d& nadir_m, const View& view) {
  return sample_terrain(view, 1, [&](const Eigen::Vector2d& off_m) {
    return ground.height_m(nadir_m + off_m) - ground.height_m(nadir_m);
  });
}

RenderedFrame frame_over(const TexturedGround& ground, double east_m, double north_m, const Attitude& attitude,
                         double agl_m) {
  GroundPlace place = ground_place(ground.crs, ground.gray.map_from_pixel,
                                   Eigen::Vector2d::Constant(static_cast<double>(ground.gray.width_px) / 2));
  const Eigen::Vector2d nadir_m(east_m, north_m);
  place.nadir_px = place.pixel_from_ground(nadir_m);
  if (!ground.height_m) return render_frame(ground.gray, place, ground.camera, attitude, agl_m);
  const auto view = make_view(ground.camera, attitude, agl_m);
  const TerrainHeights terrain = terrain_below(ground, nadir_m, *view);
  return render_terrain_frame(ground.gray, place, ground.camera, attitude, agl_m, terrain);
}

}  // namespace pilotage::testing
