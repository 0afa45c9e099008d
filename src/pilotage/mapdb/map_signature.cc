#include "pilotage/mapdb/map_signature.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>
#include <system_error>

#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/minisign_files.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxKeyFileBytes = 64 * 1024;

const unsigned char* as_unsigned(const std::string& text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

/// BLAKE2b-512, 64 bytes.
std::string prehash(const std::string& bytes) {
  std::string hash(crypto_generichash_BYTES_MAX, '\0');
  crypto_generichash(reinterpret_cast<unsigned char*>(hash.data()), hash.size(), as_unsigned(bytes), bytes.size(),
                     nullptr, 0);
  return hash;
}

bool signed_by(const std::array<std::uint8_t, 64>& signature, const std::string& message,
               const MinisignPublicKey& key) {
  return crypto_sign_verify_detached(signature.data(), as_unsigned(message), message.size(), key.key.data()) == 0;
}

MinisignPublicKey load_public_key(const std::string& public_key) {
  if (public_key.empty()) throw UsageError("public_key is empty: give a minisign public key, or its file");
  const bool is_key = public_key.size() == 56 && public_key.starts_with("RW");
  std::error_code ignored;
  try {
    if (is_key && !fs::exists(public_key, ignored)) return parse_public_key(public_key, "public key");
    return parse_public_key(read_file(public_key, kMaxKeyFileBytes), public_key);
  } catch (const DataError& error) {
    throw UsageError("public_key: " + std::string(error.what()));
  }
}

/// The one of the keys that the signature names.
const MinisignPublicKey& named_key(const std::vector<MinisignPublicKey>& keys, const MinisignSignature& signature,
                                   const std::string& signature_file) {
  std::vector<std::string> ids;
  for (const MinisignPublicKey& key : keys) {
    if (key.key_id == signature.key_id) return key;
    ids.push_back(format_key_id(key.key_id));
  }
  throw IntegrityError(signature_file + ": was made with key " + format_key_id(signature.key_id) + ", not with " +
                       join(ids, " or "));
}

}  // namespace

fs::path signature_path_of(const fs::path& path) {
  fs::path result = path;
  result += ".minisig";
  return result;
}

SignedMap read_signed_map(const fs::path& path, const std::vector<std::string>& trusted_keys,
                          const std::optional<fs::path>& signature_path) {
  if (sodium_init() < 0) throw DataError("libsodium cannot be started");
  if (trusted_keys.empty()) throw UsageError("public_key is missing: a signature is checked with a key");
  std::vector<MinisignPublicKey> keys;
  for (const std::string& key : trusted_keys) keys.push_back(load_public_key(key));
  const fs::path signature_file = signature_path.value_or(signature_path_of(path));
  const MinisignSignature signature =
      parse_signature(read_file(signature_file, kMaxKeyFileBytes), signature_file.string());
  const MinisignPublicKey& key = named_key(keys, signature, signature_file.string());
  auto bytes = std::make_shared<const std::string>(read_file(path, std::numeric_limits<std::uintmax_t>::max()));
  if (!signed_by(signature.signature, signature.prehashed ? prehash(*bytes) : *bytes, key)) {
    throw IntegrityError(path.string() + ": the signature does not match the file");
  }
  if (!signed_by(signature.global_signature, minisign_global_message(signature), key)) {
    throw IntegrityError(signature_file.string() + ": the trusted comment was changed");
  }
  return {path.string(), std::move(bytes),
          SignatureInfo{signature.trusted_comment, format_key_id(signature.key_id), signature.prehashed}};
}

}  // namespace pilotage
