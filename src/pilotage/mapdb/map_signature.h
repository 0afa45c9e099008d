#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pilotage {
class ChunkedFile;  // its symbols are not for users of the library
}

#pragma GCC visibility push(default)

namespace pilotage {

class Database;

// Detached Ed25519 signatures in the format of minisign (F. Denis, https://jedisct1.github.io/minisign), so that maps
// can be signed and checked with either program. The signature of map.gpkg stands in map.gpkg.minisig. Signing, which
// the ground does, is mapdb/map_signing.h.

struct SignatureInfo {
  std::string trusted_comment;
  std::string key_id;      ///< 16 hex digits, as minisign prints it.
  bool prehashed = false;  ///< False for the legacy form over the whole file.
};

/// A map whose signature was checked. Only read_signed_map makes one, so whoever reads a map from it reads what was
/// signed, whatever happens to the file. Either its bytes, all checked, are in memory; or, of a map whose signature
/// names a list of chunks, each chunk is checked whenever it is read from the file. Copies share either; any number of
/// threads may read.
class SignedMap {
 public:
  const std::string& name() const { return name_; }  ///< The path, as messages begin.
  const SignatureInfo& signature() const { return signature_; }
  std::uint64_t size() const;  ///< Of the file, bytes.

  /// The file's bytes, or nullptr when it is read chunk by chunk.
  const std::shared_ptr<const std::string>& bytes() const { return bytes_; }
  /// The file, or nullptr when its bytes are in memory.
  const std::shared_ptr<const ChunkedFile>& chunks() const { return chunks_; }

  /// A connection that reads what was signed. Throws DataError.
  Database open_database() const;

 private:
  friend SignedMap read_signed_map(const std::filesystem::path& path, const std::vector<std::string>& trusted_keys,
                                   const std::optional<std::filesystem::path>& signature_path);
  SignedMap(std::string name, SignatureInfo signature) : name_(std::move(name)), signature_(std::move(signature)) {}

  std::string name_;
  SignatureInfo signature_;
  std::shared_ptr<const std::string> bytes_;
  std::shared_ptr<const ChunkedFile> chunks_;
};

/// Checks a map's signature before anything of the map is parsed. Each of `trusted_keys` is the path of a minisign
/// public key file, or the key itself (56 base64 characters); one of them must have made the signature.
/// `signature_path` is `path` with ".minisig" appended unless given.
///
/// When the trusted comment names a list of chunks ("chunks:…"), the list `path`.chunks is read and checked, 1/2048 of
/// the map, and the map is read as it is needed. Else the file is read once, whole, into memory, and checked there.
///
/// Throws UsageError when there is no key, or one is empty, cannot be read or is no key: a key that is not there must
/// not pass for a check. IntegrityError when signature, trusted comment, key or list of chunks does not match;
/// DataError when the file, its signature or its list of chunks cannot be read. std::bad_alloc when the file does not
/// fit into memory.
SignedMap read_signed_map(const std::filesystem::path& path, const std::vector<std::string>& trusted_keys,
                          const std::optional<std::filesystem::path>& signature_path = {});

/// Where the signature of a file stands unless something else is said: ".minisig" appended.
std::filesystem::path signature_path_of(const std::filesystem::path& path);

/// Where the list of a map's chunks stands: ".chunks" appended.
std::filesystem::path chunk_list_path_of(const std::filesystem::path& path);

}  // namespace pilotage

#pragma GCC visibility pop
