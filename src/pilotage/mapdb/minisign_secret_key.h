#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "pilotage/mapdb/minisign_files.h"

namespace pilotage {

/// Overwrites its key when it dies.
struct MinisignSecretKey {
  std::array<std::uint8_t, 8> key_id{};
  std::array<std::uint8_t, 64> key{};  ///< Seed, then public key, as libsodium keeps it.

  MinisignSecretKey() = default;
  MinisignSecretKey(const MinisignSecretKey&) = default;
  MinisignSecretKey& operator=(const MinisignSecretKey&) = default;
  ~MinisignSecretKey();
};

/// Throws DataError beginning with `name` when the text is not a secret key, UsageError when the key is encrypted and
/// `passphrase` is missing or wrong.
MinisignSecretKey parse_secret_key(const std::string& text, const std::optional<std::string>& passphrase,
                                   const std::string& name);

std::string format_signature_file(const MinisignSignature& signature);

}  // namespace pilotage
