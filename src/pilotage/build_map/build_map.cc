#include "pilotage/build_map/build_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/text.h"
#include "pilotage/build_map/tile_owner.h"
#include "pilotage/camera/camera_text.h"
#include "pilotage/geo/enu_from_grid.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/mapdb/descriptor_row.h"
#include "pilotage/mapdb/map_writer.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr double kJacobianStep_m = 100;

struct SelectedTile {
  const GroundTile* tile = nullptr;
  RoutePlace place;
  const TileScore* score = nullptr;
};

std::vector<SelectedTile> selected_tiles(const Mission& plan, const std::vector<TileScore>& scores,
                                         const Selection& selection) {
  std::map<std::int64_t, const TileScore*> score_of_id;
  for (const TileScore& score : scores) score_of_id[score.tile_id] = &score;
  std::vector<SelectedTile> selected;
  auto tile = plan.ground.tiles.begin();
  for (const std::int64_t id : selection.tile_ids) {
    tile = std::find_if(tile, plan.ground.tiles.end(),
                        [&](const GroundTile& candidate) { return candidate.tile_id == id; });
    if (tile == plan.ground.tiles.end()) {
      throw DataError("the selection names tile " + std::to_string(id) +
                      ", which the plan does not have in this place");
    }
    const auto score = score_of_id.find(id);
    if (score == score_of_id.end()) throw DataError("tile " + std::to_string(id) + " of the selection has no score");
    selected.push_back(
        {&*tile, plan.flight.places.at(static_cast<std::size_t>(tile - plan.ground.tiles.begin())), score->second});
  }
  return selected;
}

MapHeader make_header(const Mission& plan, bool chips) {
  MapHeader header;
  header.chips = chips;
  header.crs = {plan.ground.crs.name(), plan.ground.crs.wkt(), plan.ground.crs.authority()};
  for (const GridLevel& level : plan.ground.levels) {
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
  header.description = "Reference map for visual navigation along " + plan.flight.route.name;
  return header;
}

void write_tiles(MapWriter& writer, const Mission& plan, const std::vector<SelectedTile>& selected) {
  const CrsTransform transform(plan.ground.crs);
  const auto geodetic_from_map = [&](const Eigen::Vector2d& point) { return transform.geodetic_from_map(point); };
  for (const auto& [tile, place, score] : selected) {
    MapTile row;
    row.tile_id = tile->tile_id;
    row.level = tile->level;
    row.column = tile->column;
    row.row = tile->row;
    row.bounds = tile->bounds;
    row.center = tile->center;
    row.enu_from_grid = enu_from_grid(tile->bounds.center_m(), kJacobianStep_m, geodetic_from_map);
    std::vector<MapValue> values{std::string(tile_status_name(score->status)), score->valid_fraction,
                                 place.distance_m, place.offset_m};
    for (const Measure& measure : measures()) values.emplace_back(measure.get(*score));
    values.emplace_back(reason_words(*score));
    writer.add_tile(row, values);
  }
}

// Collects the features of one level strip by strip and hands them on tile by tile, in ascending tile_id.
class LevelBuilder {
 public:
  LevelBuilder(MapWriter& writer, const Mission& plan, const GridLevel& level, std::vector<const GroundTile*> tiles,
               const BuildOptions& options, const std::optional<SecondDate>& second_date)
      : writer_(writer),
        level_(level),
        tiles_(std::move(tiles)),
        features_(options.features),
        windows_(level.matrix),
        owner_(level.matrix, cells_of(tiles_)),
        transform_(plan.ground.crs) {
    if (!plan.ground.elevation.empty()) elevation_.emplace(plan.ground.elevation);
    source_ = stretch_to_8bit(open_gray(plan.ground, level));
    if (options.keep_features == KeepFeatures::kStable) second_ = open_second_date(*second_date, plan, level);
  }

  void build(BuildStats& stats, int threads, const Progress& progress) {
    const TileMatrix& matrix = level_.matrix;
    constexpr std::int64_t kStrip_px = 4 * kFeatureBlockPx;  // whole blocks, so that none is computed twice
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
    for (; begin_px < end_px; begin_px += kStrip_px) {
      add_strip(begin_px, begin_px + kStrip_px, threads, [&](std::string_view, std::int64_t done, std::int64_t total) {
        tell(static_cast<double>(begin_px) + kStrip_px * static_cast<double>(done) / static_cast<double>(total));
        return true;
      });
      write_tiles_above(begin_px + kStrip_px, stats);
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

  // The parts of the selected tiles' windows between two rows of pixels.
  std::vector<PixelWindow> windows_of_strip(std::int64_t begin_px, std::int64_t end_px) const {
    std::vector<PixelWindow> windows;
    for (const GroundTile* tile : tiles_) {
      PixelWindow window = level_.matrix.tile_window(tile->column, tile->row);
      const std::int64_t top = std::max(window.row, begin_px);
      const std::int64_t bottom = std::min(window.row + window.height, end_px);
      if (top >= bottom) continue;
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

// The route and its legs as layers. A leg that the selection does not speak of has no status.
void write_route(MapWriter& writer, const Mission& plan, const Selection& selection) {
  std::vector<MapLine> legs;
  MapLine route;
  for (std::size_t i = 0; i < plan.flight.route.legs.size(); ++i) {
    MapLine leg;
    leg.id = static_cast<std::int64_t>(i);
    for (const FlightSample& sample : plan.flight.samples) {
      if (sample.leg == static_cast<int>(i)) leg.points.push_back(sample.point);
    }
    route.points.insert(route.points.end(), leg.points.begin(), leg.points.end());
    const LegStatus status = i < selection.legs.size() ? selection.legs[i] : LegStatus{};
    leg.values = {plan.flight.route.legs[i].length_m, status.matchable_fraction, status.max_error_m,
                  static_cast<std::int64_t>(status.within_limit ? 1 : 0)};
    legs.push_back(std::move(leg));
  }
  route.values = {plan.flight.route.name, route_length_m(plan.flight.route)};
  writer.write_route({{"name", MapColumnType::kText, "Name of the route file"},
                      {"length_m", MapColumnType::kReal, "Length of all legs [m]"}},
                     {route});
  writer.write_legs({{"length_m", MapColumnType::kReal, "Length [m]"},
                     {"matchable_fraction", MapColumnType::kReal, "Share of the length over matching areas"},
                     {"max_error_m", MapColumnType::kReal, "Largest predicted position error, k sigma [m]"},
                     {"within_limit", MapColumnType::kInteger, "1 when the error stays within its limit"}},
                    legs);
}

template <class Options>
void write_options(MapWriter& writer, const std::string& prefix, Options options) {
  for (const OptionField& field : list_options(options).fields) {
    const OptionValue value = field.get();
    if (!std::holds_alternative<std::monostate>(value)) writer.add_info(prefix + field.path, option_to_text(value));
  }
}

void write_info(MapWriter& writer, const Mission& plan, const Selection& selection, const BuildOptions& options,
                const std::vector<InputFile>& inputs, const std::string& software_version, const BuildStats& stats) {
  writer.add_info("tool_version", software_version);
  for (const auto& [key, value] : camera_to_text(plan.flight.camera)) writer.add_info("camera." + key, value);
  write_options(writer, "features.", options.features);
  if (stats.stable) {
    writer.add_info("keep_features", "stable");
    writer.add_info("keep_features.survived", std::to_string(stats.stable->survived));
    writer.add_info("keep_features.not_known", std::to_string(stats.stable->not_known));
    writer.add_info("keep_features.dropped", std::to_string(stats.stable->dropped));
    writer.add_info("keep_features.refilled", std::to_string(stats.stable->refilled));
    writer.add_info("keep_features.tiles_refilled", std::to_string(stats.stable->tiles_refilled));
  }
  if (options.chips.chips) {
    writer.add_info("chips.gsd_m", format_number(options.chips.chip_gsd_m));
    writer.add_info("chips.gray_bits", std::to_string(options.chips.chip_gray_bits));
  }
  write_options(writer, "ins.", plan.flight.ins);
  write_options(writer, "imagery.", plan.ground.imagery.options);
  writer.add_info("max_error_m", format_number(selection.max_error_m));
  writer.add_info("sigma_multiple", format_number(selection.sigma_multiple));
  writer.add_info("max_scale_distortion", format_number(plan.ground.max_scale_distortion));
  int index = 0;
  for (const InputFile& file : inputs) {
    const std::string prefix = "input." + std::to_string(index++) + ".";
    writer.add_info(prefix + "role", file.role);
    writer.add_info(prefix + "name", file.name);
    writer.add_info(prefix + "date", file.date);
    writer.add_info(prefix + "digest", file.digest);
  }
}

}  // namespace

StoredSize stored_size(const BuildOptions& options, const Mission& plan) {
  constexpr double kPageBytes = 4096;     // the last page of a blob is half empty on average, full at worst
  constexpr double kTileRowBytes = 1200;  // geometry, scores, R-tree entry
  constexpr double kChipRowBytes = 600;   // its other columns, and the head of its blob
  constexpr double kEmptyMapBytes = 262144;
  constexpr double kFullPages = 1.02;  // page headers and overflow pointers
  const double bytes_per_feature = kKeypointBytes + options.features.descriptor_bits / 8.0;
  StoredSize size{options.features.features_per_mpx * 1e-6 * bytes_per_feature * kFullPages,
                  kPageBytes + kTileRowBytes,
                  kEmptyMapBytes,
                  {}};
  if (options.chips.chips) {
    size.bytes_per_tile += kPageBytes + kChipRowBytes;
    for (const GridLevel& level : plan.ground.levels) {
      size.chip_bytes_per_px.push_back(chip_bytes_per_px(options.chips, level.gsd_m));
    }
  }
  return size;
}

BuildStats build_map(const std::filesystem::path& path, const Mission& plan, const std::vector<TileScore>& scores,
                     const Selection& selection, const std::vector<InputFile>& inputs,
                     const std::string& software_version, const BuildOptions& options, bool overwrite, int threads,
                     const Progress& progress, const std::optional<SecondDate>& second_date) {
  check_options(options);
  check_feature_options(options.features);
  const bool stable = options.keep_features == KeepFeatures::kStable;
  if (stable && !second_date) throw UsageError("keep_features = stable needs a second date: give --second-epoch");
  const auto selected = selected_tiles(plan, scores, selection);

  MapWriter writer(path, make_header(plan, options.chips.chips), overwrite);
  write_tiles(writer, plan, selected);
  BuildStats stats;
  stats.tiles = static_cast<std::int64_t>(selected.size());
  if (stable) stats.stable.emplace();
  for (const GridLevel& level : plan.ground.levels) {
    std::vector<const GroundTile*> tiles;
    for (const SelectedTile& entry : selected) {
      if (entry.tile->level == level.matrix.level) tiles.push_back(entry.tile);
    }
    if (tiles.empty()) continue;
    LevelBuilder builder(writer, plan, level, std::move(tiles), options, second_date);
    builder.build(stats, threads, progress);
    if (options.chips.chips) builder.build_chips(stats, options.chips, threads, progress);
  }
  write_route(writer, plan, selection);
  write_info(writer, plan, selection, options, inputs, software_version, stats);
  stats.content_digest = writer.finish();
  stats.bytes = static_cast<std::int64_t>(std::filesystem::file_size(path));
  return stats;
}

}  // namespace pilotage
