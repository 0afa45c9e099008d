// Any bytes as tiles.csv: DataError, or rows that their own table gives again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "fuzz/fuzz_targets.h"

#include "pilotage/base/error.h"
#include "pilotage/ground/tile_table.h"

namespace pilotage {

void fuzz_tiles(const std::uint8_t* data, std::size_t size) {
  std::string table;
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    table = tile_table_to_csv(tile_table_from_csv("fuzz", text));
  } catch (const DataError&) {
    return;
  }
  if (tile_table_to_csv(tile_table_from_csv("again", table)) != table) std::abort();
}

}  // namespace pilotage
