// Any bytes as a map: MapReader reads everything it can, and nothing but DataError may come out.

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/chip_codec.h"
#include "pilotage/mapdb/map_reader.h"

namespace {

/// One file per process, in memory where the system has /dev/shm.
std::filesystem::path input_file() {
  std::error_code ignored;
  const std::filesystem::path memory = "/dev/shm";
  const std::filesystem::path folder =
      std::filesystem::is_directory(memory, ignored) ? memory : std::filesystem::temp_directory_path();
  return folder / ("pilotage-map-fuzz-" + std::to_string(::getpid()) + ".gpkg");
}

void read_everything(const std::filesystem::path& path) {
  pilotage::MapReader reader(path);
  std::size_t left = 2000;  // a damaged R-tree may name the same tile often
  for (const pilotage::MapTile& tile : reader.tiles()) {
    if (left-- == 0) break;
    static_cast<void>(reader.tile(tile.tile_id));
    static_cast<void>(reader.tile_values(tile.tile_id));
    static_cast<void>(reader.tiles_near(tile.center, 100, tile.level));
    static_cast<void>(reader.tiles_near(tile.bounds.center_m(), 100));
    for (const pilotage::MapLevel& level : reader.levels()) {
      static_cast<void>(reader.descriptors(tile.tile_id, level.matrix.level));
      if (const auto chip = reader.chip(tile.tile_id, level.matrix.level)) {
        static_cast<void>(pilotage::decode_chip(*chip, reader.name()));
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path path = input_file();
  {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    if (!file) std::abort();
  }
  try {
    read_everything(path);
  } catch (const pilotage::DataError&) {
  }
  std::filesystem::remove(path);
  return 0;
}
