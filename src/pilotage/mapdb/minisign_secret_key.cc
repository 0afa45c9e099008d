#include "pilotage/mapdb/minisign_secret_key.h"

#include <algorithm>
#include <span>
#include <vector>

#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/byte_order.h"

namespace pilotage {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kSecretKeyBytes = 158;  // below
// Where the parts of a secret key file lie.
constexpr std::size_t kKdfAt = 2;
constexpr std::size_t kChecksumKindAt = 4;
constexpr std::size_t kSaltAt = 6;
constexpr std::size_t kOperationsAt = 38;
constexpr std::size_t kMemoryAt = 46;
constexpr std::size_t kKeyIdAt = 54;
constexpr std::size_t kKeyAt = 62;
constexpr std::size_t kChecksumAt = 126;
constexpr std::size_t kEncryptedBytes = kSecretKeyBytes - kKeyIdAt;

/// How much work and memory scrypt takes to turn a passphrase into a key.
struct ScryptCost {
  std::uint64_t operations = 0;
  std::uint64_t memory_bytes = 0;
};
// A key file is not trusted: no more than minisign's own cost (1 GiB, seconds).
constexpr ScryptCost kMaxCost{33554432, 1073741824};

std::string to_base64(std::span<const std::uint8_t> bytes) {
  std::string text(sodium_base64_encoded_len(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // the terminating NUL
  return text;
}

void xor_with_scrypt(std::span<std::uint8_t> bytes, const std::string& passphrase, const std::uint8_t* salt,
                     const ScryptCost& cost) {
  Bytes stream(bytes.size());
  if (crypto_pwhash_scryptsalsa208sha256(stream.data(), stream.size(), passphrase.data(), passphrase.size(), salt,
                                         cost.operations, static_cast<std::size_t>(cost.memory_bytes)) != 0) {
    throw DataError("there is not enough memory for the passphrase's scrypt (" + std::to_string(cost.memory_bytes) +
                    " bytes)");
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ stream[i]);
  sodium_memzero(stream.data(), stream.size());
}

/// BLAKE2b-256 over algorithm, key id and key.
std::array<std::uint8_t, 32> checksum_of(const Bytes& file) {
  Bytes covered(file.begin(), file.begin() + 2);
  covered.insert(covered.end(), file.begin() + kKeyIdAt, file.begin() + kChecksumAt);
  std::array<std::uint8_t, 32> checksum{};
  crypto_generichash(checksum.data(), checksum.size(), covered.data(), covered.size(), nullptr, 0);
  sodium_memzero(covered.data(), covered.size());
  return checksum;
}

/// The public half stands in the secret key; it must be the one that belongs to the seed.
bool halves_match(const std::array<std::uint8_t, 64>& key) {
  std::array<std::uint8_t, 32> public_key{};
  std::array<std::uint8_t, 64> again{};
  crypto_sign_seed_keypair(public_key.data(), again.data(), key.data());
  const bool match = sodium_memcmp(again.data(), key.data(), key.size()) == 0;
  sodium_memzero(again.data(), again.size());
  return match;
}

void decrypt(Bytes& bytes, const std::optional<std::string>& passphrase, const std::string& name) {
  if (!passphrase) throw UsageError(name + ": the secret key is encrypted; its passphrase is needed");
  const ScryptCost cost{read_le<std::uint64_t>(bytes.data() + kOperationsAt),
                        read_le<std::uint64_t>(bytes.data() + kMemoryAt)};
  if (cost.operations > kMaxCost.operations || cost.memory_bytes > kMaxCost.memory_bytes) {
    throw DataError(name + ": asks for more work or memory than minisign's own keys do");
  }
  xor_with_scrypt(std::span(bytes).subspan(kKeyIdAt, kEncryptedBytes), *passphrase, bytes.data() + kSaltAt, cost);
  const auto checksum = checksum_of(bytes);
  if (!std::equal(checksum.begin(), checksum.end(), bytes.begin() + kChecksumAt)) {
    throw UsageError(name + ": the passphrase is wrong");
  }
}

}  // namespace

MinisignSecretKey::~MinisignSecretKey() {
  sodium_memzero(key.data(), key.size());
}

MinisignSecretKey parse_secret_key(const std::string& text, const std::optional<std::string>& passphrase,
                                   const std::string& name) {
  const std::vector<std::string> lines = minisign_lines(text);
  if (lines.size() < 2 || !lines[0].starts_with(kMinisignUntrusted))
    throw DataError(name + ": is not a minisign secret key");
  Bytes bytes = minisign_bytes(lines[1], kSecretKeyBytes, name, "secret key");
  const bool encrypted = has_minisign_tag(bytes, kKdfAt, "Sc");
  const bool known_kdf = encrypted || (bytes[kKdfAt] == 0 && bytes[kKdfAt + 1] == 0);
  if (!has_minisign_tag(bytes, 0, "Ed") || !has_minisign_tag(bytes, kChecksumKindAt, "B2") || !known_kdf) {
    throw DataError(name + ": is a secret key of an unknown kind");
  }
  if (encrypted) decrypt(bytes, passphrase, name);  // minisign writes no checksum into keys in clear
  MinisignSecretKey key;
  take_bytes(bytes, kKeyIdAt, key.key_id);
  take_bytes(bytes, kKeyAt, key.key);
  sodium_memzero(bytes.data(), bytes.size());
  if (!halves_match(key.key)) throw DataError(name + ": the secret key is damaged");
  return key;
}

std::string format_signature_file(const MinisignSignature& signature) {
  Bytes bytes = {'E', static_cast<std::uint8_t>(signature.prehashed ? 'D' : 'd')};
  bytes.insert(bytes.end(), signature.key_id.begin(), signature.key_id.end());
  bytes.insert(bytes.end(), signature.signature.begin(), signature.signature.end());
  return std::string(kMinisignUntrusted) + "signature from pilotage\n" + to_base64(bytes) + "\n" +
         std::string(kMinisignTrusted) + signature.trusted_comment + "\n" + to_base64(signature.global_signature) +
         "\n";
}

}  // namespace pilotage
