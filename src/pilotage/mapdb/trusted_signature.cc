#include "pilotage/mapdb/trusted_signature.h"

#include <system_error>

#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr std::uintmax_t kMaxKeyFileBytes = 64 * 1024;

const unsigned char* as_unsigned(std::string_view text) {
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
    if (is_key && !std::filesystem::exists(public_key, ignored)) return parse_public_key(public_key, "public key");
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

TrustedSignature read_trusted_signature(const std::filesystem::path& signature_file,
                                        const std::vector<std::string>& trusted_keys) {
  if (sodium_init() < 0) throw DataError("libsodium cannot be started");
  if (trusted_keys.empty()) throw UsageError("public_key is missing: a signature is checked with a key");
  std::vector<MinisignPublicKey> keys;
  for (const std::string& key : trusted_keys) keys.push_back(load_public_key(key));
  const std::string name = signature_file.string();
  TrustedSignature trusted;
  trusted.signature = parse_signature(read_file(signature_file, kMaxKeyFileBytes), name);
  trusted.key = named_key(keys, trusted.signature, name);
  if (!signed_by(trusted.signature.global_signature, minisign_global_message(trusted.signature), trusted.key)) {
    throw IntegrityError(name + ": the signature or its trusted comment was changed");
  }
  return trusted;
}

void check_signed_bytes(const std::string& name, const std::string& bytes, const TrustedSignature& trusted) {
  const MinisignSignature& signature = trusted.signature;
  if (signed_by(signature.signature, signature.prehashed ? prehash(bytes) : bytes, trusted.key)) return;
  throw IntegrityError(name + ": the signature does not match the file");
}

std::array<std::uint8_t, 32> blake2b_256(std::string_view bytes) {
  std::array<std::uint8_t, 32> digest{};
  crypto_generichash(digest.data(), digest.size(), as_unsigned(bytes), bytes.size(), nullptr, 0);
  return digest;
}

}  // namespace pilotage
