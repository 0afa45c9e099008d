#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/mapdb/map_reader.h"

namespace pilotage {

/// What one level of a map holds.
struct MapLevelSummary {
  MapLevel level;
  std::int64_t tiles = 0;
  std::int64_t tiles_with_descriptors = 0;
  std::int64_t descriptors = 0;
  std::int64_t descriptor_blob_bytes = 0;  ///< Key points and descriptors.
  std::int64_t chips = 0;
  std::int64_t chip_bytes = 0;
};

/// What `pilotage inspect map.gpkg` prints.
struct MapSummary {
  std::string file;  ///< Without its folder.
  std::int64_t file_bytes = 0;
  MapInfo info;
  std::vector<MapColumn> tile_columns;
  std::vector<MapLevelSummary> levels;
  std::int64_t tiles = 0;
  std::int64_t route_lines = 0;
  std::int64_t legs = 0;
  std::int64_t landmarks = 0;
  std::vector<std::string> landmark_classes;  ///< That it has detectors of.
  std::vector<std::string> extensions;        ///< Names in gpkg_extensions, sorted, each once.
  /// Mean over the tiles that have any: key points, descriptors and chips. NaN when none has.
  double bytes_per_tile = 0;
  double descriptor_bytes_per_tile = 0;  ///< Its two parts, over the same tiles.
  double chip_bytes_per_tile = 0;
};

/// Whether a file declares the table map_info, which other GeoPackages do not have: sound or not, it means to be a map.
bool declares_map(const std::filesystem::path& path);

/// Reads the summary without checking digests. Throws DataError.
MapSummary inspect_map(const std::filesystem::path& path);

/// The summary as JSON, keys as the fields are named; map_info becomes an object in its own order.
nlohmann::ordered_json to_json(const MapSummary& summary);

}  // namespace pilotage
