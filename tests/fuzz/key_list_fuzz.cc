// Any bytes as a key list: DataError, or a list whose keys are keys.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/key_list_text.h"
#include "pilotage/mapdb/minisign_files.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const pilotage::KeyList list =
        pilotage::parse_key_list(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
    for (const pilotage::ListedKey& key : list.signers) {
      if (list.find_signer(key.key_id) != &key) std::abort();
      static_cast<void>(pilotage::parse_public_key(key.key, "fuzz"));
    }
  } catch (const pilotage::DataError&) {
  }
  return 0;
}
