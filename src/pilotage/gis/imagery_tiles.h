#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/ground/ground.h"

namespace pilotage {

/// A tile of the web's maps: of 2^zoom × 2^zoom squares in EPSG:3857, columns from the west, rows from the north (XYZ).
struct WebTile {
  int zoom = 0;
  std::int64_t column = 0;
  std::int64_t row = 0;

  bool operator==(const WebTile&) const = default;
  bool operator<(const WebTile& other) const {
    return std::tie(zoom, column, row) < std::tie(other.zoom, other.column, other.row);
  }
};

/// Most tiles of the finest level of imagery tiles, some 750 MB of them.
inline constexpr std::int64_t kMostImageryTiles = 50'000;

/// What the files say of themselves.
struct ImageryTilesText {
  std::string name;
  std::string description;
  std::string attribution;  ///< HTML; "" where nobody is to be named.
};

/// The web's tiles over the tiles of a ground, each once, in ascending order: of the zoom level whose pixels are next
/// in size (by ratio) to those of the finest imagery, at that latitude, or the next coarser one with no more than
/// `most` tiles; then of each coarser level up to the first that shows all in at most four tiles. Empty where tiles lie
/// on both sides of the antimeridian or beyond 85° of latitude, where EPSG:3857 ends.
std::vector<WebTile> imagery_tiles_of(const Ground& ground, std::int64_t most = kMostImageryTiles);

/// Writes the imagery of these tiles as MBTiles 1.3 (github.com/mapbox/mbtiles-spec): JPEG of 256 × 256 pixels, quality
/// 85, black where there is no imagery; a tile without any is left out. One band gives gray; what is not 8 bits deep is
/// stretched between the 2nd and 98th percentile of the gray of the coarsest level, all bands and levels alike. Tiles
/// are read one after the other, so memory does not grow with the area. The same imagery gives the same bytes for any
/// number of threads. False, and no file, where no tile has any. Throws DataError when imagery cannot be read or the
/// file cannot be written, UsageError for no tiles, Interrupted.
bool write_imagery_mbtiles(const std::filesystem::path& path, const Imagery& imagery, const std::vector<WebTile>& tiles,
                           const ImageryTilesText& text, bool overwrite, int threads, const Progress& progress = {});

}  // namespace pilotage
