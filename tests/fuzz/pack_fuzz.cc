// Any bytes as the manifest of a field pack: DataError, or a manifest that reads back as it was written.
#include <cstddef>
#include <cstdint>
#include <string>

#include "fuzz/fuzz_targets.h"

#include "pilotage/base/error.h"
#include "pilotage/pack/field_pack.h"

namespace pilotage {

void fuzz_pack(const std::uint8_t* data, std::size_t size) {
  try {
    const PackManifest manifest =
        pack_manifest_from_text(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
    for (const PackFile& file : manifest.files) {
      require(file.name.find('/') == std::string::npos, "a name leads out of the folder");
    }
    const std::string text = pack_manifest_text(manifest);
    require(pack_manifest_text(pack_manifest_from_text(text, "again")) == text, "it reads back as it was written");
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
