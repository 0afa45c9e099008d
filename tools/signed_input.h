#pragma once

#include <optional>
#include <string>

#include "pilotage/mapdb/map_signature.h"

namespace pilotage {

/// The key that a map's signature is checked with, for the commands that read maps.
struct SignatureOptions {
  std::optional<std::string> public_key;
  std::optional<std::string> signature;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("public_key", self.public_key,
                "Check the signature first, before anything is read: a minisign public key, or its file.");
    fields.path("signature", self.signature, "Signature file; the map's name with .minisig appended if not given.");
  }
};

/// The map at `path`, read and checked; nothing when no key was given. Throws UsageError when a key or signature was
/// given and is empty, or a signature without a key; DataError when there is no map; as read_signed_map.
std::optional<SignedMap> read_signed_input(const SignatureOptions& options, const std::string& path);

}  // namespace pilotage
