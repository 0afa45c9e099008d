#pragma once

#include <cstdint>
#include <filesystem>

namespace pilotage {

/// The number of a tile in PMTiles: all tiles of the levels before it, and its place on the Hilbert curve of its own
/// (PMTiles 3, "Tile ID"). `zoom` 0 … 31, column and row from the west and the north, below 2^zoom.
std::uint64_t pmtiles_id(int zoom, std::int64_t column, std::int64_t row);

/// Writes the tiles and metadata of an MBTiles file of JPEG as one PMTiles 3 archive
/// (github.com/protomaps/PMTiles/blob/main/spec/v3/spec.md), which web maps read over plain HTTP: clustered, its
/// directories not compressed. The tiles are copied one after the other. Throws DataError when `mbtiles` cannot be
/// read, has no tile, or the archive cannot be written.
void write_pmtiles(const std::filesystem::path& path, const std::filesystem::path& mbtiles, bool overwrite);

}  // namespace pilotage
