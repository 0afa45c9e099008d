#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace pilotage {

// The three files of minisign (F. Denis, https://jedisct1.github.io/minisign, "Formats") as values.

struct MinisignPublicKey {
  std::array<std::uint8_t, 8> key_id{};
  std::array<std::uint8_t, 32> key{};
};

/// Overwrites its key when it dies.
struct MinisignSecretKey {
  std::array<std::uint8_t, 8> key_id{};
  std::array<std::uint8_t, 64> key{};  ///< Seed, then public key, as libsodium keeps it.

  MinisignSecretKey() = default;
  MinisignSecretKey(const MinisignSecretKey&) = default;
  MinisignSecretKey& operator=(const MinisignSecretKey&) = default;
  ~MinisignSecretKey();
};

struct MinisignSignature {
  bool prehashed = true;
  std::array<std::uint8_t, 8> key_id{};
  std::array<std::uint8_t, 64> signature{};
  std::string trusted_comment;
  std::array<std::uint8_t, 64> global_signature{};  ///< Over signature and trusted comment.
};

/// Each parse function throws DataError beginning with `name` when the text is not what it should be.

/// The key alone (56 base64 characters) or the text of a public key file.
MinisignPublicKey parse_public_key(const std::string& text, const std::string& name);

/// Throws UsageError when the key is encrypted and `passphrase` is missing or wrong.
MinisignSecretKey parse_secret_key(const std::string& text, const std::optional<std::string>& passphrase,
                                   const std::string& name);

MinisignSignature parse_signature(const std::string& text, const std::string& name);
std::string format_signature_file(const MinisignSignature& signature);

/// 16 hex digits, as minisign prints a key id.
std::string format_key_id(const std::array<std::uint8_t, 8>& key_id);

}  // namespace pilotage
