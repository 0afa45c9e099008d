// Any bytes as a map: everything that commands ask of one, and nothing but DataError may come out.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "fuzz/fuzz_targets.h"
#include "fuzz/input_file.h"
#include "testing/forged_map.h"

#include "pilotage/base/error.h"
#include "pilotage/mapdb/chip_codec.h"
#include "pilotage/mapdb/map_inspect.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

void read_everything(const std::filesystem::path& path) {
  MapReader reader = MapReader::open_unverified(path);
  std::size_t left = 30;  // tiles that are asked for one by one, each of which may cost what a whole map may
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

template <class Call>
void ask(const Call& call) {
  try {
    call();
  } catch (const DataError&) {
  }
}

}  // namespace

void fuzz_map(const std::uint8_t* data, std::size_t size) {
  const FuzzFile file(data, size, ".gpkg");
  ask([&] { read_everything(file.path()); });
  ask([&] { static_cast<void>(inspect_map(file.path())); });
  ask([&] { static_cast<void>(verify_map(file.path())); });
}

std::string forge_map(const std::string& bytes, Random& random) {
  try {
    testing::ForgedFile file(bytes);
    for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) file.change_at_random(random);
    return file.bytes();
  } catch (const std::invalid_argument&) {  // changed before, so that it is no file of whole pages
    return bytes;
  }
}

}  // namespace pilotage
