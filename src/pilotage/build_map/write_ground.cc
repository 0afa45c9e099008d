#include "pilotage/build_map/write_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/build_map/tile_owner.h"
#include "pilotage/geo/enu_from_grid.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/measures.h"
#include "pilotage/mapdb/descriptor_row.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/mapdb/map_tables.h"
#include "pilotage/mission/planned_landmarks.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr double kJacobianStep_m = 100;

bool says_map_sigma(const Ground& ground) {
  return std::any_of(ground.tiles.begin(), ground.tiles.end(),
                     [](const GroundTile& tile) { return tile.map_sigma_m.has_value(); });
}

void write_tiles(MapWriter& writer, const ScoreTable& table, std::span<const std::size_t> stored,
                 std::span<const RoutePlace> places) {
  constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
  const CrsTransform transform(table.ground.crs);
  const auto geodetic_from_map = [&](const Eigen::Vector2d& point) { return transform.geodetic_from_map(point); };
  const bool with_map_sigma = says_map_sigma(table.ground);
  for (const std::size_t i : stored) {
    const GroundTile& tile = table.ground.tiles[i];
    const TileScores& scores = table.scores[i];
    const RoutePlace place = places.empty() ? RoutePlace{kNotKnown, kNotKnown} : places[i];
    MapTile row;
    row.tile_id = tile.tile_id;
    row.level = tile.level;
    row.column = tile.column;
    row.row = tile.row;
    row.bounds = tile.bounds;
    row.center = tile.center;
    row.enu_from_grid = enu_from_grid(tile.bounds.center_m(), kJacobianStep_m, geodetic_from_map);
    std::vector<MapValue> values{std::string(tile_status_name(scores.status)), scores.valid_fraction, place.distance_m,
                                 place.offset_m};
    for (const Measure& measure : measures()) values.emplace_back(measure.get(scores));
    values.emplace_back(reason_words(scores));
    if (with_map_sigma) values.emplace_back(tile.map_sigma_m ? MapValue(*tile.map_sigma_m) : MapValue());
    writer.add_tile(row, values);
  }
}

// Collects the features of one level strip by strip and hands them on tile by tile, in ascending tile_id.
class LevelBuilder {
 public:
  LevelBuilder(MapWriter& writer, const Ground& ground, const GridLevel& level, std::vector<const GroundTile*> tiles,
               const BuildOptions& options, const std::optional<SecondDate>& second_date, const GroundImagery* imagery)
      : writer_(writer),
        level_(level),
        tiles_(std::move(tiles)),
        features_(options.features),
        windows_(level.matrix),
        owner_(level.matrix, cells_of(tiles_)),
        transform_(ground.crs) {
    if (!ground.elevation.empty()) elevation_.emplace(ground.elevation);
    source_ = stretch_to_8bit(imagery == nullptr ? open_gray(ground, level)
                                                 : imagery->levels[static_cast<std::size_t>(level.matrix.level)].gray);
    if (options.keep_features == KeepFeatures::kStable) second_ = open_second_date(*second_date, ground, level);
  }

  void build(BuildStats& stats, int threads, const Progress& progress) {
    const TileMatrix& matrix = level_.matrix;
    std::int64_t begin_px = tiles_.front()->row * matrix.stride_px / kFeatureBlockPx * kFeatureBlockPx;
    const std::int64_t end_px = tiles_.back()->row * matrix.stride_px + matrix.tile_size_px;
    const std::string what = "describing level " + std::to_string(matrix.level);
    const double rows_px = static_cast<double>(end_px - begin_px);
    const std::int64_t first_px = begin_px;
    // Counted in tiles, by the rows of pixels that are done: a strip is seconds of work.
    const auto tell = [&](double row_px) {
      const double share = std::min(1.0, (row_px - static_cast<double>(first_px)) / rows_px);
      report_progress(progress, what, std::llround(share * static_cast<double>(tiles_.size())), std::ssize(tiles_));
    };
    tell(static_cast<double>(begin_px));
    while (begin_px < end_px) {
      const std::int64_t strip_px = strip_height_px(begin_px);
      const std::int64_t strip_end_px = begin_px + strip_px;
      add_strip(begin_px, strip_end_px, threads, [&](std::string_view, std::int64_t done, std::int64_t total) {
        const double of_strip = static_cast<double>(done) / static_cast<double>(total);
        tell(static_cast<double>(begin_px) + static_cast<double>(strip_px) * of_strip);
        return true;
      });
      write_tiles_above(strip_end_px, stats);
      begin_px = strip_end_px;
    }
    stats.descriptors += descriptors_;
    stats.descriptor_bytes += descriptors_ * (kKeypointBytes + features_.descriptor_bits / 8);
  }

  void build_chips(BuildStats& stats, const ChipOptions& options, int threads, const Progress& progress) {
    const ChipStats chips = write_chips(writer_, level_, tiles_, owner_, source_, options, threads, progress);
    stats.chips += chips.chips;
    stats.chip_bytes += chips.bytes;
  }

 private:
  static std::vector<TileCell> cells_of(const std::vector<const GroundTile*>& tiles) {
    std::vector<TileCell> cells;
    for (const GroundTile* tile : tiles) cells.push_back({tile->column, tile->row});
    return cells;
  }

  // Selected tiles with pixels between two rows of them.
  std::span<const GroundTile* const> tiles_between(std::int64_t begin_px, std::int64_t end_px) const {
    const TileMatrix& matrix = level_.matrix;
    const auto first = std::partition_point(tiles_.begin(), tiles_.end(), [&](const GroundTile* tile) {
      return tile->row * matrix.stride_px + matrix.tile_size_px <= begin_px;
    });
    const auto last = std::partition_point(
        first, tiles_.end(), [&](const GroundTile* tile) { return tile->row * matrix.stride_px < end_px; });
    return {first, last};
  }

  // Whole blocks of features, so that none is computed twice: four rows of them, less where many tiles lie side by
  // side, so that what is in memory does not grow with the length of the map.
  std::int64_t strip_height_px(std::int64_t begin_px) const {
    constexpr std::int64_t kMostTilePixels = std::int64_t{64} << 20;
    const std::int64_t side_px = std::min(level_.matrix.stride_px, level_.matrix.tile_size_px);
    std::int64_t height_px = 4 * kFeatureBlockPx;
    while (height_px > kFeatureBlockPx &&
           std::ssize(tiles_between(begin_px, begin_px + height_px)) * side_px * side_px > kMostTilePixels) {
      height_px /= 2;
    }
    return height_px;
  }

  // The parts of the selected tiles' windows between two rows of pixels.
  std::vector<PixelWindow> windows_of_strip(std::int64_t begin_px, std::int64_t end_px) const {
    std::vector<PixelWindow> windows;
    for (const GroundTile* tile : tiles_between(begin_px, end_px)) {
      PixelWindow window = level_.matrix.tile_window(tile->column, tile->row);
      const std::int64_t top = std::max(window.row, begin_px);
      const std::int64_t bottom = std::min(window.row + window.height, end_px);
      window.row = top;
      window.height = static_cast<int>(bottom - top);
      windows.push_back(window);
    }
    return windows;
  }

  void add_strip(std::int64_t begin_px, std::int64_t end_px, int threads, const Progress& progress) {
    const FeatureSet found =
        extract_features_of_map(source_, windows_of_strip(begin_px, end_px), features_, threads, progress);
    std::vector<FeatureFate> fates;
    if (second_) fates = feature_fates(found, *second_, features_, threads);
    for (std::size_t i = 0; i < found.size(); ++i) {
      Feature feature = found.features[i];
      const auto cell = owner_.owner_of(feature.x_px, feature.y_px);
      if (!cell) continue;
      const auto key = std::pair(cell->row, cell->column);
      Pending& pending = pending_[key];
      TileDescriptors& stored = pending.stored;
      if (second_) {
        pending.fates.push_back(fates[i]);
        if (fates[i] != FeatureFate::kGone) windows_.add(feature.x_px, feature.y_px);
      }
      stored.window = level_.matrix.tile_window(cell->column, cell->row);
      stored.features.pattern = found.pattern;
      stored.features.descriptor_bytes = found.descriptor_bytes;
      if (elevation_) stored.ground_height_m.push_back(ground_height_m(feature));
      feature.x_px -= static_cast<float>(stored.window.col);
      feature.y_px -= static_cast<float>(stored.window.row);
      stored.features.features.push_back(feature);
      const std::uint8_t* descriptor = found.descriptor(i);
      stored.features.descriptors.insert(stored.features.descriptors.end(), descriptor,
                                         descriptor + found.descriptor_bytes);
    }
  }

  float ground_height_m(const Feature& feature) const {
    const auto point =
        transform_.geodetic_from_map(level_.matrix.map_from_pixel.map_from_pixel({feature.x_px, feature.y_px}));
    return point ? static_cast<float>(elevation_->amsl_m(*point)) : std::numeric_limits<float>::quiet_NaN();
  }

  // Tiles that end above this row of pixels get no more features.
  void write_tiles_above(std::int64_t row_px, BuildStats& stats) {
    while (written_ < tiles_.size()) {
      const GroundTile& tile = *tiles_[written_];
      if (tile.row * level_.matrix.stride_px + level_.matrix.tile_size_px > row_px) return;
      ++written_;
      auto found = pending_.extract({tile.row, tile.column});
      if (found.empty()) continue;
      TileDescriptors& stored = found.mapped().stored;
      stored.tile_id = tile.tile_id;
      stored.level = tile.level;
      if (second_) {
        drop_contradicted(stored.features, stored.ground_height_m, found.mapped().fates,
                          windows_.take(tile.column, tile.row), *stats.stable);
      }
      descriptors_ += static_cast<std::int64_t>(stored.features.size());
      if (stored.features.size() > 0) writer_.add_descriptors(stored);
    }
  }

  struct Pending {
    TileDescriptors stored;
    std::vector<FeatureFate> fates;  // with a second date
  };

  MapWriter& writer_;
  const GridLevel& level_;
  std::vector<const GroundTile*> tiles_;  // ascending tile_id: by row, then column
  FeatureOptions features_;
  WindowCounts windows_;
  TileOwner owner_;
  CrsTransform transform_;
  std::optional<Elevation> elevation_;
  GraySource source_;
  std::optional<GraySource> second_;                                  // with keep_features = stable
  std::map<std::pair<std::int64_t, std::int64_t>, Pending> pending_;  // by (row, column)
  std::size_t written_ = 0;
  std::int64_t descriptors_ = 0;
};

}  // namespace

MapHeader map_header(const Ground& ground, const std::string& description, const BuildOptions& options) {
  MapHeader header;
  header.chips = options.chips.chips;
  header.landmarks = !options.landmarks.empty();
  header.crs = {ground.crs.name(), ground.crs.wkt(), ground.crs.authority()};
  for (const GridLevel& level : ground.levels) {
    header.levels.push_back({level.matrix, level.gsd_m, level.min_agl_m, level.max_agl_m, 0});
  }
  header.tile_columns.push_back({"status", MapColumnType::kText, "What became of the tile when it was scored"});
  header.tile_columns.push_back({coverage_measure().name, MapColumnType::kReal, coverage_measure().description});
  header.tile_columns.push_back({"route_distance_m", MapColumnType::kReal, "Along the route, at its nearest point"});
  header.tile_columns.push_back({"route_offset_m", MapColumnType::kReal, "From the route to the tile's centre"});
  for (const Measure& measure : measures()) {
    header.tile_columns.push_back({measure.name, MapColumnType::kReal,
                                   measure.description + (measure.unit.empty() ? "" : " [" + measure.unit + "]")});
  }
  header.tile_columns.push_back(
      {"reasons", MapColumnType::kText, "Why it may not be recognised, joined by semicolons"});
  if (says_map_sigma(ground)) {
    header.tile_columns.push_back({std::string(kMapSigmaColumn), MapColumnType::kReal,
                                   "Standard deviation of where the imagery lies, each axis [m]"});
  }
  header.description = description;
  return header;
}

BuildStats write_ground(MapWriter& writer, const ScoreTable& table, std::span<const std::int64_t> tile_ids,
                        std::span<const RoutePlace> places, const BuildOptions& options, int threads,
                        const Progress& progress, const std::optional<SecondDate>& second_date,
                        const GroundImagery* imagery) {
  check_options(options);
  check_feature_options(options.features);
  const bool stable = options.keep_features == KeepFeatures::kStable;
  if (stable && !second_date) throw UsageError("keep_features = stable needs a second date: give --second-epoch");
  std::optional<MapLandmarks> landmarks;  // before hours of work
  if (!options.landmarks.empty()) landmarks = read_planned_landmarks(table.ground, options.landmarks);
  std::vector<std::size_t> stored;
  for (const std::int64_t tile_id : tile_ids) {
    stored.push_back(tile_index(table.ground, tile_id, "the selection"));
    if (stored.size() > 1 && stored.back() <= stored[stored.size() - 2]) {
      throw DataError("the selection: tile " + std::to_string(tile_id) + " is out of order, or a duplicate");
    }
  }
  write_tiles(writer, table, stored, places);
  const std::optional<double>& elevation_sigma_m = table.ground.elevation_sigma_m;
  if (elevation_sigma_m) writer.add_info("elevation_sigma_m", format_number(*elevation_sigma_m));
  BuildStats stats;
  stats.tiles = std::ssize(stored);
  if (stable) stats.stable.emplace();
  for (const GridLevel& level : table.ground.levels) {
    std::vector<const GroundTile*> tiles;
    for (const std::size_t i : stored) {
      if (table.ground.tiles[i].level == level.matrix.level) tiles.push_back(&table.ground.tiles[i]);
    }
    if (tiles.empty()) continue;
    LevelBuilder builder(writer, table.ground, level, std::move(tiles), options, second_date, imagery);
    builder.build(stats, threads, progress);
    if (options.chips.chips) builder.build_chips(stats, options.chips, threads, progress);
  }
  if (landmarks) {
    writer.write_landmarks(*landmarks);
    stats.landmarks = std::ssize(landmarks->landmarks);
    stats.detectors = std::ssize(landmarks->detectors);
  }
  return stats;
}

}  // namespace pilotage
