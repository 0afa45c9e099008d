#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pilotage/mapdb/minisign_secret_key.h"

namespace pilotage::testing {

/// What `minisign -G -W` writes: a secret key in clear and its public key. Returns the public key (56 base64
/// characters).
std::string generate_key_pair(const std::filesystem::path& secret_key_path,
                              const std::filesystem::path& public_key_path);

/// Work and memory that scrypt takes to turn a passphrase into a key.
struct ScryptCost {
  std::uint64_t operations;
  std::uint64_t memory_bytes;
};

/// The text of a secret key file that a passphrase encrypts, as minisign lays it out.
std::string encrypted_secret_key_file(const MinisignSecretKey& key, const std::string& passphrase,
                                      const ScryptCost& cost);

}  // namespace pilotage::testing
