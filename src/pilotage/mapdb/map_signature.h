#pragma once

#include <filesystem>
#include <optional>
#include <string>

#pragma GCC visibility push(default)

namespace pilotage {

// Detached Ed25519 signatures in the format of minisign (F. Denis, https://jedisct1.github.io/minisign), so that maps
// can be signed and checked with either program. The signature of map.gpkg stands in map.gpkg.minisig.

struct SignOptions {
  /// Where the signature goes; by default beside the file, with ".minisig" appended.
  std::optional<std::filesystem::path> signature_path;
  /// Signed together with the signature; one line. By default "file:NAME\thashed": no date, so that the bytes repeat.
  std::optional<std::string> trusted_comment;
  /// Needed when the secret key is encrypted.
  std::optional<std::string> passphrase;
  bool overwrite = false;
};

/// Signs a file (prehashed: Ed25519 over BLAKE2b-512) with a minisign secret key file, encrypted with a passphrase
/// (`minisign -G`) or not (`minisign -G -W`). Returns the path of the signature. Throws DataError when a file cannot be
/// read or is not a secret key, UsageError when a passphrase is missing or wrong.
std::filesystem::path sign_file(const std::filesystem::path& path, const std::filesystem::path& secret_key_path,
                                const SignOptions& options = {});

struct SignatureInfo {
  std::string trusted_comment;
  std::string key_id;      ///< 16 hex digits, as minisign prints it.
  bool prehashed = false;  ///< False for the legacy form over the whole file.
};

/// Checks a file against its signature. `public_key` is the path of a minisign public key file, or the key itself (56
/// base64 characters). `signature_path` is `path` with ".minisig" appended unless given. Throws IntegrityError when the
/// signature, the trusted comment or the key does not match, DataError when a file cannot be read or is not what it
/// should be.
SignatureInfo verify_signature(const std::filesystem::path& path, const std::string& public_key,
                               const std::optional<std::filesystem::path>& signature_path = {});

}  // namespace pilotage

#pragma GCC visibility pop
