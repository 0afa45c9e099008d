#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#pragma GCC visibility push(default)

namespace pilotage {

// Detached Ed25519 signatures in the format of minisign (F. Denis, https://jedisct1.github.io/minisign), so that maps
// can be signed and checked with either program. The signature of map.gpkg stands in map.gpkg.minisig. Signing, which
// the ground does, is mapdb/map_signing.h.

struct SignatureInfo {
  std::string trusted_comment;
  std::string key_id;      ///< 16 hex digits, as minisign prints it.
  bool prehashed = false;  ///< False for the legacy form over the whole file.
};

/// The bytes of a file whose signature was checked. Only read_signed_map makes one, so whoever reads a map from it
/// reads what was checked, whatever happened to the file since. Copies share the bytes; any number of threads may read.
class SignedMap {
 public:
  const std::string& name() const { return name_; }  ///< The path, as messages begin.
  const SignatureInfo& signature() const { return signature_; }
  const std::shared_ptr<const std::string>& bytes() const { return bytes_; }

 private:
  friend SignedMap read_signed_map(const std::filesystem::path& path, const std::vector<std::string>& trusted_keys,
                                   const std::optional<std::filesystem::path>& signature_path);
  SignedMap(std::string name, std::shared_ptr<const std::string> bytes, SignatureInfo signature)
      : name_(std::move(name)), bytes_(std::move(bytes)), signature_(std::move(signature)) {}

  std::string name_;
  std::shared_ptr<const std::string> bytes_;
  SignatureInfo signature_;
};

/// Reads the file once, whole, into memory, and checks the signature over these bytes before anything of them is
/// parsed. Each of `trusted_keys` is the path of a minisign public key file, or the key itself (56 base64 characters);
/// one of them must have made the signature. `signature_path` is `path` with ".minisig" appended unless given.
///
/// Throws UsageError when there is no key, or one is empty, cannot be read or is no key: a key that is not there must
/// not pass for a check. IntegrityError when signature, trusted comment or key does not match; DataError when the file
/// or its signature cannot be read. std::bad_alloc when the file does not fit into memory.
SignedMap read_signed_map(const std::filesystem::path& path, const std::vector<std::string>& trusted_keys,
                          const std::optional<std::filesystem::path>& signature_path = {});

/// Where the signature of a file stands unless something else is said: ".minisig" appended.
std::filesystem::path signature_path_of(const std::filesystem::path& path);

}  // namespace pilotage

#pragma GCC visibility pop
