#include "pilotage/build_map/build_map.h"

#include <optional>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/text.h"
#include "pilotage/build_map/write_ground.h"
#include "pilotage/camera/camera_text.h"
#include "pilotage/mapdb/descriptor_row.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/mapdb/map_writer.h"
#include "pilotage/mission/landmark_file.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

// The route and its legs as layers. A leg that the selection does not speak of has no status.
void write_route(MapWriter& writer, const Mission& mission, const Selection& selection) {
  std::vector<MapLine> legs;
  MapLine route;
  for (std::size_t i = 0; i < mission.flight.route.legs.size(); ++i) {
    MapLine leg;
    leg.id = static_cast<std::int64_t>(i);
    for (const FlightSample& sample : mission.flight.samples) {
      if (sample.leg == static_cast<int>(i)) leg.points.push_back(sample.point);
    }
    route.points.insert(route.points.end(), leg.points.begin(), leg.points.end());
    const LegStatus status = i < selection.legs.size() ? selection.legs[i] : LegStatus{};
    leg.values = {mission.flight.route.legs[i].length_m, status.matchable_fraction, status.max_error_m,
                  static_cast<std::int64_t>(status.within_limit ? 1 : 0)};
    legs.push_back(std::move(leg));
  }
  route.values = {mission.flight.route.name, route_length_m(mission.flight.route)};
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

/// What the map holds of each tile.
void write_stored_features(MapWriter& writer, const BuildOptions& options, const BuildStats& stats) {
  write_options(writer, "features.", options.features);
  const std::string tests = pattern_digest(options.features.pattern);
  if (!tests.empty()) writer.add_info("pattern_digest", tests);
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
}

/// The route, its legs, and what the flight and its map were made from.
void write_flight(MapWriter& writer, const Mission& mission, const Selection& selection, const BuildOptions& options,
                  const MapPurpose& purpose, const std::vector<InputFile>& inputs, const std::string& software_version,
                  const BuildStats& stats) {
  write_route(writer, mission, selection);
  writer.add_info("tool_version", software_version);
  for (const MapInfoEntry& entry : purpose_entries(purpose)) writer.add_info(entry.key, entry.value);
  for (const auto& [key, value] : camera_to_text(mission.flight.camera)) writer.add_info("camera." + key, value);
  write_stored_features(writer, options, stats);
  write_options(writer, "ins.", mission.flight.ins);
  write_options(writer, "imagery.", mission.ground.imagery.options);
  writer.add_info("max_error_m", format_number(selection.max_error_m));
  writer.add_info("sigma_multiple", format_number(selection.sigma_multiple));
  writer.add_info("max_scale_distortion", format_number(mission.ground.max_scale_distortion));
  int index = 0;
  for (const InputFile& file : inputs) {
    const std::string prefix = "input." + std::to_string(index++) + ".";
    writer.add_info(prefix + "role", file.role);
    writer.add_info(prefix + "name", file.name);
    writer.add_info(prefix + "date", file.date);
    writer.add_info(prefix + "digest", file.digest);
    if (!file.licence.terms.empty()) writer.add_info(prefix + "licence", file.licence.terms);
    if (!file.licence.attribution.empty()) writer.add_info(prefix + "attribution", file.licence.attribution);
  }
}

BuildStats finished(MapWriter& writer, const std::filesystem::path& path, BuildStats stats) {
  stats.content_digest = writer.finish();
  stats.bytes = static_cast<std::int64_t>(std::filesystem::file_size(path));
  return stats;
}

}  // namespace

StoredSize stored_size(const BuildOptions& options, const Ground& ground) {
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
    for (const GridLevel& level : ground.levels) {
      size.chip_bytes_per_px.push_back(chip_bytes_per_px(options.chips, level.gsd_m));
    }
  }
  if (!options.landmarks.empty()) {
    constexpr double kLandmarkRowBytes = 200;
    const MapLandmarks landmarks = read_map_landmarks(options.landmarks);
    size.bytes_fixed += kLandmarkRowBytes * static_cast<double>(landmarks.landmarks.size());
    for (const MapDetector& one : landmarks.detectors) {
      size.bytes_fixed += kPageBytes + kFullPages * static_cast<double>(filter_bytes(one.detector).size());
    }
  }
  return size;
}

BuildStats build_map(const std::filesystem::path& path, const Mission& mission, const std::vector<TileScores>& scores,
                     const Selection& selection, const std::vector<InputFile>& inputs,
                     const std::string& software_version, const BuildOptions& options, bool overwrite, int threads,
                     const Progress& progress, const std::optional<SecondDate>& second_date,
                     const GroundImagery* imagery, const MapPurpose& purpose) {
  const std::string description = "Reference map for visual navigation along " + mission.flight.route.name;
  MapWriter writer(path, map_header(mission.ground, description, options), overwrite);
  BuildStats stats = write_ground(writer, {mission.ground, scores}, selection.tile_ids, mission.flight.places, options,
                                  threads, progress, second_date, imagery);
  write_flight(writer, mission, selection, options, purpose, inputs, software_version, stats);
  return finished(writer, path, std::move(stats));
}

BuildStats build_ground_map(const std::filesystem::path& path, const ScoreTable& table,
                            const std::vector<std::int64_t>& tile_ids, const BuildOptions& options, int threads,
                            const Progress& progress) {
  MapWriter writer(path, map_header(table.ground, "Reference map", options), true);
  BuildStats stats = write_ground(writer, table, tile_ids, {}, options, threads, progress);
  write_stored_features(writer, options, stats);
  return finished(writer, path, std::move(stats));
}

}  // namespace pilotage
