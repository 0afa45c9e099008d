#pragma once

#include <filesystem>
#include <optional>
#include <string>

#pragma GCC visibility push(default)

namespace pilotage {

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

}  // namespace pilotage

#pragma GCC visibility pop
