#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#pragma GCC visibility push(default)

namespace pilotage {

/// Maps of more bytes are signed with a list of their chunks, so that an aircraft need not read them whole.
inline constexpr std::uintmax_t kChunkListAboveBytes = std::uintmax_t{64} << 20;

/// For SignOptions::chunk_list_above_bytes: a file that is always read whole has no list.
inline constexpr std::uintmax_t kNoChunkList = std::numeric_limits<std::uintmax_t>::max();

struct SignOptions {
  /// Where the signature goes; by default beside the file, with ".minisig" appended.
  std::optional<std::filesystem::path> signature_path;
  /// Where the list of chunks goes, when there is one; by default beside the file, with ".chunks" appended.
  std::optional<std::filesystem::path> chunk_list_path;
  /// A file of more bytes gets a list of its chunks, which the trusted comment then names.
  std::uintmax_t chunk_list_above_bytes = kChunkListAboveBytes;
  /// Signed together with the signature; one line. By default "file:NAME\thashed": no date, so that the bytes repeat.
  std::optional<std::string> trusted_comment;
  /// Needed when the secret key is encrypted.
  std::optional<std::string> passphrase;
  bool overwrite = false;
};

/// What sign_file wrote.
struct SignatureFiles {
  std::filesystem::path signature;
  std::optional<std::filesystem::path> chunk_list;
};

/// Throws as sign_file when the secret key cannot be used, so that a command that signs at its end fails at its start.
void check_secret_key(const std::filesystem::path& secret_key_path, const std::optional<std::string>& passphrase);

/// Signs a file (prehashed: Ed25519 over BLAKE2b-512) with a minisign secret key file, encrypted with a passphrase
/// (`minisign -G`) or not (`minisign -G -W`), and lists its chunks when it is large. Signature and list appear
/// together; a list of an earlier signature is removed. Throws DataError when a file cannot be read or is not a secret
/// key, UsageError when a passphrase is missing or wrong.
SignatureFiles sign_file(const std::filesystem::path& path, const std::filesystem::path& secret_key_path,
                         const SignOptions& options = {});

/// The same of a file that is always read whole, so that it has no list of chunks; its signature goes to `signature`.
void sign_whole_file(const std::filesystem::path& path, const std::filesystem::path& signature,
                     const std::filesystem::path& secret_key_path, SignOptions options);

}  // namespace pilotage

#pragma GCC visibility pop
