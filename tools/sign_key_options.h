#pragma once

#include <optional>
#include <string>

#include "pilotage/base/options.h"
#include "pilotage/mapdb/map_signing.h"

namespace pilotage {

/// How a command that makes a map signs it.
struct SignKeyOptions {
  std::optional<std::string> sign_key;
  double chunk_list_above_mib = static_cast<double>(kChunkListAboveBytes >> 20);

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("sign_key", self.sign_key,
                "Sign the map with this minisign secret key; the passphrase comes from PILOTAGE_KEY_PASSPHRASE.");
    fields.field("chunk_list_above_mib", self.chunk_list_above_mib,
                 "A larger map is signed with a list of its chunks (MAP.chunks), so that it is not read whole to be "
                 "checked.",
                 Range{0, 1e9});
  }
};

/// What sign_file is to do, but for the paths. Throws UsageError for an empty sign_key, and as check_secret_key.
SignOptions checked_sign_options(const SignKeyOptions& options);

}  // namespace pilotage
