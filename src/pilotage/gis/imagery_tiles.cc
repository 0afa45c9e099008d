#include "pilotage/gis/imagery_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/mapdb/sqlite.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr int kTile_px = 256;
constexpr int kJpegQuality = 85;
constexpr int kDeepestZoom = 24;
constexpr double kWebEdge_deg = 85;
constexpr double kWebHalf_m = std::numbers::pi * 6378137;  // of EPSG:3857, from its middle to its edge
constexpr double kRadians = std::numbers::pi / 180;

/// A rectangle of tiles of one level.
struct WebRange {
  std::int64_t first_column = 0;
  std::int64_t last_column = 0;
  std::int64_t first_row = 0;
  std::int64_t last_row = 0;

  std::int64_t columns() const { return last_column - first_column + 1; }
  std::int64_t rows() const { return last_row - first_row + 1; }
};

double side_m(int zoom) {
  return 2 * kWebHalf_m / static_cast<double>(std::int64_t{1} << zoom);
}

/// The tiles of a level that a rectangle in EPSG:3857 touches.
WebRange range_of(const Bounds& bounds, int zoom) {
  const std::int64_t last = (std::int64_t{1} << zoom) - 1;
  const auto index = [&](double offset_m, bool at_end) {
    const double tiles = offset_m / side_m(zoom);
    const double whole = at_end ? std::ceil(tiles) - 1 : std::floor(tiles);
    return std::clamp(static_cast<std::int64_t>(whole), std::int64_t{0}, last);
  };
  WebRange range{index(bounds.min_x_m + kWebHalf_m, false), index(bounds.max_x_m + kWebHalf_m, true),
                 index(kWebHalf_m - bounds.max_y_m, false), index(kWebHalf_m - bounds.min_y_m, true)};
  range.last_column = std::max(range.first_column, range.last_column);
  range.last_row = std::max(range.first_row, range.last_row);
  return range;
}

/// The rectangles around the ground's tiles in EPSG:3857; none where they leave it or lie on both its ends.
std::vector<Bounds> places_on_web_map(const Ground& ground) {
  const CrsTransform to_degrees(ground.crs);
  const CrsTransform to_web(Crs::from_user_input("EPSG:3857"));
  double west_deg = 180;
  double east_deg = -180;
  std::vector<Bounds> places;
  for (const GroundTile& tile : ground.tiles) {
    Bounds place;
    const Bounds b = ground.level_of(tile).matrix.tile_bounds(tile.cell());
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(b.min_x_m, b.min_y_m), Eigen::Vector2d(b.max_x_m, b.min_y_m),
          Eigen::Vector2d(b.max_x_m, b.max_y_m), Eigen::Vector2d(b.min_x_m, b.max_y_m)}) {
      const auto point = to_degrees.geodetic_from_map(corner);
      if (!point || std::abs(point->lat_deg) > kWebEdge_deg) return {};
      west_deg = std::min(west_deg, point->lon_deg);
      east_deg = std::max(east_deg, point->lon_deg);
      const auto on_web = to_web.map_from_geodetic(*point);
      if (!on_web) return {};
      place.extend(*on_web);
    }
    places.push_back(place);
  }
  if (east_deg - west_deg > 180) return {};
  return places;
}

/// The tiles of a level that touch any of the places; nothing when they are more than `most`.
std::optional<std::set<WebTile>> tiles_over(const std::vector<Bounds>& places, int zoom, std::int64_t most) {
  std::set<WebTile> tiles;
  for (const Bounds& place : places) {
    const WebRange range = range_of(place, zoom);
    if (range.columns() > most || range.rows() > most) return std::nullopt;
    for (std::int64_t row = range.first_row; row <= range.last_row; ++row) {
      for (std::int64_t column = range.first_column; column <= range.last_column; ++column) {
        tiles.insert({zoom, column, row});
        if (std::ssize(tiles) > most) return std::nullopt;
      }
    }
  }
  return tiles;
}

int zoom_of(double gsd_m, double lat_deg) {
  const double coarsest_m = side_m(0) / kTile_px * std::cos(lat_deg * kRadians);
  return std::clamp(static_cast<int>(std::lround(std::log2(coarsest_m / gsd_m))), 0, kDeepestZoom);
}

/// The imagery of one level, and how it is made a picture of 8 bits.
struct WebLevel {
  WebRange range;
  ColorSource colors;
  GrayStretch stretch;

  cv::Mat read(const WebTile& tile) const {
    const Raster raster = colors.read(
        {(tile.column - range.first_column) * kTile_px, (tile.row - range.first_row) * kTile_px, kTile_px, kTile_px});
    if (cv::countNonZero(raster.valid) == 0) return {};
    cv::Mat picture = raster.pixels;
    if (picture.depth() != CV_8U) picture = apply_stretch(picture.reshape(1), stretch).reshape(picture.channels());
    if (picture.channels() == 3) {
      cv::Mat bgr;
      cv::cvtColor(picture, bgr, cv::COLOR_RGB2BGR);
      picture = bgr;
    } else {
      picture = picture.clone();  // the source may share its pixels
    }
    picture.setTo(cv::Scalar::all(0), raster.valid == 0);
    return picture;
  }
};

/// Around tiles of one level.
WebRange range_around(std::span<const WebTile> tiles) {
  const WebTile& first = tiles.front();
  WebRange range{first.column, first.column, first.row, first.row};
  for (const WebTile& tile : tiles) {
    range.first_column = std::min(range.first_column, tile.column);
    range.last_column = std::max(range.last_column, tile.column);
    range.first_row = std::min(range.first_row, tile.row);
    range.last_row = std::max(range.last_row, tile.row);
  }
  return range;
}

WebLevel open_level(const Imagery& imagery, std::span<const WebTile> tiles) {
  WebLevel level;
  level.range = range_around(tiles);
  const double side = side_m(tiles.front().zoom);
  const GeoTransform place =
      GeoTransform::north_up(static_cast<double>(level.range.first_column) * side - kWebHalf_m,
                             kWebHalf_m - static_cast<double>(level.range.first_row) * side, side / kTile_px);
  level.colors = open_colors_on_grid(dataset_names(imagery), Crs::from_user_input("EPSG:3857"), place,
                                     level.range.columns() * kTile_px, level.range.rows() * kTile_px, imagery.options);
  return level;
}

std::vector<std::uint8_t> jpeg_of(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality})) {
    throw DataError("a tile of imagery cannot be written as JPEG");
  }
  return bytes;
}

/// The tiles of each level, the finest first.
std::vector<std::span<const WebTile>> levels_of(const std::vector<WebTile>& tiles) {
  std::vector<std::span<const WebTile>> levels;
  auto begin = tiles.begin();
  while (begin != tiles.end()) {
    const auto end = std::find_if(begin, tiles.end(), [&](const WebTile& tile) { return tile.zoom != begin->zoom; });
    levels.emplace_back(begin, end);
    begin = end;
  }
  std::reverse(levels.begin(), levels.end());
  return levels;
}

/// Around the tiles of one level: west, south, east, north in degrees.
std::array<double, 4> bounds_deg(const WebRange& range, int zoom) {
  const double count = static_cast<double>(std::int64_t{1} << zoom);
  const auto lon_deg = [&](std::int64_t column) { return static_cast<double>(column) / count * 360 - 180; };
  const auto lat_deg = [&](std::int64_t row) {
    return std::atan(std::sinh(std::numbers::pi * (1 - 2 * static_cast<double>(row) / count))) / kRadians;
  };
  return {lon_deg(range.first_column), lat_deg(range.last_row + 1), lon_deg(range.last_column + 1),
          lat_deg(range.first_row)};
}

void write_metadata(const Database& database, const std::vector<std::pair<std::string, std::string>>& rows) {
  Statement insert = database.prepare("INSERT INTO metadata VALUES (?, ?)", "metadata");
  for (const auto& [name, value] : rows) {
    insert.bind(1, std::string_view(name)).bind(2, std::string_view(value)).run();
  }
}

/// Fills the table tiles, level by level; returns how many have imagery.
std::int64_t write_tiles(const Database& database, const Imagery& imagery,
                         const std::vector<std::span<const WebTile>>& levels, int threads, const Progress& progress) {
  Statement insert = database.prepare("INSERT INTO tiles VALUES (?, ?, ?, ?)", "tiles");
  std::int64_t total = 0;
  for (const std::span<const WebTile>& of_level : levels) total += std::ssize(of_level);
  std::int64_t done = 0;
  std::int64_t written = 0;
  std::optional<GrayStretch> stretch;
  for (const std::span<const WebTile>& of_level : levels) {
    WebLevel level = open_level(imagery, of_level);
    if (level.colors.depth != CV_8U) {
      if (!stretch) stretch = find_stretch(gray_source_of(open_level(imagery, levels.back()).colors), 2, 98);
      level.stretch = *stretch;
    }
    constexpr std::size_t kBatch = 64;
    for (std::size_t begin = 0; begin < of_level.size(); begin += kBatch) {
      report_progress(progress, "writing tiles of imagery", done, total);
      const std::span<const WebTile> batch = of_level.subspan(begin, std::min(kBatch, of_level.size() - begin));
      std::vector<std::vector<std::uint8_t>> pictures(batch.size());
      parallel_for(batch.size(), threads, [&](std::size_t i, int /*worker*/) {
        const cv::Mat picture = level.read(batch[i]);
        if (!picture.empty()) pictures[i] = jpeg_of(picture);
      });
      for (std::size_t i = 0; i < batch.size(); ++i) {
        if (pictures[i].empty()) continue;
        const WebTile& tile = batch[i];
        const std::int64_t row_from_south = (std::int64_t{1} << tile.zoom) - 1 - tile.row;  // TMS, as MBTiles count
        insert.bind(1, std::int64_t{tile.zoom}).bind(2, tile.column).bind(3, row_from_south);
        insert.bind(4, std::span<const std::uint8_t>(pictures[i])).run();
        ++written;
      }
      done += std::ssize(batch);
    }
  }
  report_progress(progress, "writing tiles of imagery", total, total);
  return written;
}

}  // namespace

std::vector<WebTile> imagery_tiles_of(const Ground& ground, std::int64_t most) {
  const std::vector<Bounds> places = places_on_web_map(ground);
  if (places.empty() || ground.imagery.datasets.empty()) return {};
  double gsd_m = std::numeric_limits<double>::infinity();
  for (const ImageryDataset& dataset : ground.imagery.datasets) gsd_m = std::min(gsd_m, dataset.gsd_m);
  int zoom = zoom_of(gsd_m, ground.tiles.front().center.lat_deg);
  std::optional<std::set<WebTile>> finest = tiles_over(places, zoom, most);
  while (!finest && zoom > 0) finest = tiles_over(places, --zoom, most);
  if (!finest) return {};
  std::set<WebTile> all = *finest;
  std::set<WebTile> level = *std::move(finest);
  while (level.size() > 4 && zoom > 0) {
    --zoom;
    std::set<WebTile> coarser;
    for (const WebTile& tile : level) coarser.insert({zoom, tile.column / 2, tile.row / 2});
    all.insert(coarser.begin(), coarser.end());
    level = std::move(coarser);
  }
  return {all.begin(), all.end()};
}

bool write_imagery_mbtiles(const std::filesystem::path& path, const Imagery& imagery, const std::vector<WebTile>& tiles,
                           const ImageryTilesText& text, bool overwrite, int threads, const Progress& progress) {
  if (tiles.empty()) throw UsageError(path.string() + ": there is no tile of imagery to write");
  OutputFile output(path, overwrite);
  Database database = Database::create(output.temporary_path(), path.string());
  database.execute(
      "PRAGMA application_id = 1297105496;"  // "MPBX", by which programs know MBTiles
      "CREATE TABLE metadata (name TEXT, value TEXT);"
      "CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB);"
      "BEGIN");
  const std::vector<std::span<const WebTile>> levels = levels_of(tiles);
  if (write_tiles(database, imagery, levels, threads, progress) == 0) return false;
  const int finest = levels.front().front().zoom;
  const auto [west, south, east, north] = bounds_deg(range_around(levels.front()), finest);
  std::vector<std::pair<std::string, std::string>> metadata{
      {"name", text.name},
      {"format", "jpg"},
      {"bounds", format_fixed(west, 7) + "," + format_fixed(south, 7) + "," + format_fixed(east, 7) + "," +
                     format_fixed(north, 7)},
      {"center", format_fixed((west + east) / 2, 7) + "," + format_fixed((south + north) / 2, 7) + "," +
                     std::to_string(levels.back().front().zoom)},
      {"minzoom", std::to_string(levels.back().front().zoom)},
      {"maxzoom", std::to_string(finest)},
      {"type", "baselayer"},
      {"version", "1"},
      {"description", text.description}};
  if (!text.attribution.empty()) metadata.emplace_back("attribution", text.attribution);
  write_metadata(database, metadata);
  database.execute("CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row); COMMIT");
  database.close();
  output.commit();
  return true;
}

}  // namespace pilotage
