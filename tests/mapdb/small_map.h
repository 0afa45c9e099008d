#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/mapdb/map_writer.h"

namespace pilotage::testing {

/// How a synthetic map is laid out: square tiles side by side on UTM, `columns` × `rows` of them on each level.
struct SmallMapOptions {
  int columns = 3;
  int rows = 2;
  int levels = 2;
  int features_per_tile = 5;
  int tile_size_px = 64;
  bool chips = true;
  bool northern_hemisphere = false;
  double west_m = 380000;  ///< Easting of the western edge in the zone of the central meridian 117°.
  double south_m = 6440000;
};

/// What was written, for comparing with what is read.
struct SmallMap {
  MapHeader header;
  std::vector<MapTile> tiles;
  std::vector<std::vector<MapValue>> values;
  std::vector<TileDescriptors> descriptors;
  std::vector<MapChip> chips;
  std::vector<MapLine> route;
  std::vector<MapLine> legs;
  std::vector<MapInfoEntry> info;  ///< As given to add_info.
  std::string content_digest;
};

/// The contents, nothing written yet; every feature lies on the grid of 1/16 px, so that it is read back exactly.
SmallMap make_small_map(const SmallMapOptions& options = {});

/// Writes contents in the order of the spec: info, tiles, descriptors, chips, route, legs. Returns the content digest.
std::string write_map(const std::filesystem::path& path, const SmallMap& map, bool overwrite = false);

}  // namespace pilotage::testing
