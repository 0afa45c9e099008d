// Any bytes as a map: MapReader reads everything it can, and nothing but DataError may come out.

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "fuzz/fuzz_targets.h"
#include "fuzz/input_file.h"

#include "pilotage/base/error.h"
#include "pilotage/mapdb/chip_codec.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {
namespace {

void read_everything(const std::filesystem::path& path) {
  MapReader reader = MapReader::open_unverified(path);
  std::size_t left = 2000;  // a damaged R-tree may name the same tile often
  for (const MapTile& tile : reader.tiles()) {
    if (left-- == 0) break;
    static_cast<void>(reader.tile(tile.tile_id));
    static_cast<void>(reader.tile_values(tile.tile_id));
    static_cast<void>(reader.tiles_near(tile.center, 100, tile.level));
    static_cast<void>(reader.tiles_near(tile.bounds.center_m(), 100));
    for (const MapLevel& level : reader.levels()) {
      static_cast<void>(reader.descriptors(tile.tile_id, level.matrix.level));
      if (const auto chip = reader.chip(tile.tile_id, level.matrix.level)) {
        static_cast<void>(decode_chip(*chip, reader.name()));
      }
    }
  }
}

}  // namespace

void fuzz_map(const std::uint8_t* data, std::size_t size) {
  const InputFile file(data, size, ".gpkg");
  try {
    read_everything(file.path());
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
