// Any bytes as a key list: DataError, or a list whose keys are keys.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "fuzz/fuzz_targets.h"

#include "pilotage/base/error.h"
#include "pilotage/mapdb/key_list_text.h"
#include "pilotage/mapdb/minisign_files.h"

namespace pilotage {

void fuzz_key_list(const std::uint8_t* data, std::size_t size) {
  try {
    const KeyList list = parse_key_list(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
    for (const ListedKey& key : list.signers) {
      if (list.find_signer(key.key_id) != &key) std::abort();
      static_cast<void>(parse_public_key(key.key, "fuzz"));
    }
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
