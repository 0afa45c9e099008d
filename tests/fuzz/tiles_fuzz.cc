// Any bytes as tiles.csv: DataError, or rows that their own table gives again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "pilotage/base/error.h"
#include "pilotage/ground/tile_table.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string table;
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    table = pilotage::tile_table_to_csv(pilotage::tile_table_from_csv("fuzz", text));
  } catch (const pilotage::DataError&) {
    return 0;
  }
  if (pilotage::tile_table_to_csv(pilotage::tile_table_from_csv("again", table)) != table) std::abort();
  return 0;
}
