// Any bytes as a delta of the map whose bytes are 0, 1, 2, … (whatever map the delta says that it is of): DataError, or
// what was made is what it says.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fuzz/fuzz_targets.h"
#include "fuzz/input_file.h"

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/mapdb/byte_order.h"
#include "pilotage/mapdb/map_delta_format.h"
#include "pilotage/mapdb/trusted_signature.h"

namespace pilotage {

void fuzz_delta(const std::uint8_t* data, std::size_t size) {
  std::string old_map(8192, '\0');
  for (std::size_t i = 0; i < old_map.size(); ++i) old_map[i] = static_cast<char>(i % 251);
  const FuzzFile before(reinterpret_cast<const std::uint8_t*>(old_map.data()), old_map.size(), ".old");
  const FuzzFile after(data, size, ".new");
  std::string delta(reinterpret_cast<const char*>(data), size);
  if (delta.size() >= kMapDeltaMagic.size() + 40) {
    std::vector<std::uint8_t> of_old;
    append_le(of_old, static_cast<std::uint64_t>(old_map.size()));
    const auto digest = blake2b_256(old_map);
    of_old.insert(of_old.end(), digest.begin(), digest.end());
    delta.replace(kMapDeltaMagic.size(), of_old.size(), std::string(of_old.begin(), of_old.end()));
  }
  try {
    const MapDeltaHeader header = unpack_map_delta(delta, "fuzz", before.path(), after.path());
    require(std::filesystem::file_size(after.path()) == header.new_bytes, "what is made has the size that is said");
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
