#include "pilotage/mapdb/minisign_files.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/byte_order.h"

namespace pilotage {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::string_view kUntrusted = "untrusted comment: ";
constexpr std::string_view kTrusted = "trusted comment: ";
constexpr std::size_t kPublicKeyBytes = 42;   // "Ed", key id, key
constexpr std::size_t kSignatureBytes = 74;   // "Ed" or "ED", key id, signature
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

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(std::move(line));
    at = end + 1;
  }
  return lines;
}

std::string to_base64(std::span<const std::uint8_t> bytes) {
  std::string text(sodium_base64_encoded_len(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // the terminating NUL
  return text;
}

/// Exactly `size` bytes of base64 that begin with "E".
Bytes from_base64(std::string_view text, std::size_t size, const std::string& name, const char* what) {
  Bytes bytes(size);
  std::size_t length = 0;
  const int result = sodium_base642bin(bytes.data(), bytes.size(), text.data(), text.size(), nullptr, &length, nullptr,
                                       sodium_base64_VARIANT_ORIGINAL);
  if (result != 0 || length != size) throw DataError(name + ": is not a minisign " + what);
  return bytes;
}

template <std::size_t N>
void take(const Bytes& bytes, std::size_t at, std::array<std::uint8_t, N>& part) {
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), N, part.begin());
}

bool has_tag(const Bytes& bytes, std::size_t at, std::string_view tag) {
  return bytes[at] == static_cast<std::uint8_t>(tag[0]) && bytes[at + 1] == static_cast<std::uint8_t>(tag[1]);
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

std::string format_key_id(const std::array<std::uint8_t, 8>& key_id) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string text;
  for (auto it = key_id.rbegin(); it != key_id.rend(); ++it) text += {kHex[*it >> 4], kHex[*it & 15]};
  return text;
}

MinisignPublicKey parse_public_key(const std::string& text, const std::string& name) {
  const std::vector<std::string> lines = lines_of(text);
  const bool with_comment = !lines.empty() && lines[0].starts_with(kUntrusted);
  if (lines.size() < (with_comment ? 2U : 1U)) throw DataError(name + ": is not a minisign public key");
  const Bytes bytes = from_base64(lines[with_comment ? 1 : 0], kPublicKeyBytes, name, "public key");
  if (!has_tag(bytes, 0, "Ed")) throw DataError(name + ": is a key of another algorithm than Ed25519");
  MinisignPublicKey key;
  take(bytes, 2, key.key_id);
  take(bytes, 10, key.key);
  return key;
}

MinisignSecretKey parse_secret_key(const std::string& text, const std::optional<std::string>& passphrase,
                                   const std::string& name) {
  const std::vector<std::string> lines = lines_of(text);
  if (lines.size() < 2 || !lines[0].starts_with(kUntrusted)) throw DataError(name + ": is not a minisign secret key");
  Bytes bytes = from_base64(lines[1], kSecretKeyBytes, name, "secret key");
  const bool encrypted = has_tag(bytes, kKdfAt, "Sc");
  const bool known_kdf = encrypted || (bytes[kKdfAt] == 0 && bytes[kKdfAt + 1] == 0);
  if (!has_tag(bytes, 0, "Ed") || !has_tag(bytes, kChecksumKindAt, "B2") || !known_kdf) {
    throw DataError(name + ": is a secret key of an unknown kind");
  }
  if (encrypted) decrypt(bytes, passphrase, name);  // minisign writes no checksum into keys in clear
  MinisignSecretKey key;
  take(bytes, kKeyIdAt, key.key_id);
  take(bytes, kKeyAt, key.key);
  sodium_memzero(bytes.data(), bytes.size());
  if (!halves_match(key.key)) throw DataError(name + ": the secret key is damaged");
  return key;
}

MinisignSignature parse_signature(const std::string& text, const std::string& name) {
  const std::vector<std::string> lines = lines_of(text);
  if (lines.size() < 4 || !lines[0].starts_with(kUntrusted) || !lines[2].starts_with(kTrusted)) {
    throw DataError(name + ": is not a minisign signature");
  }
  const Bytes bytes = from_base64(lines[1], kSignatureBytes, name, "signature");
  MinisignSignature signature;
  signature.prehashed = has_tag(bytes, 0, "ED");
  if (!signature.prehashed && !has_tag(bytes, 0, "Ed")) {
    throw DataError(name + ": is a signature of another algorithm than Ed25519");
  }
  take(bytes, 2, signature.key_id);
  take(bytes, 10, signature.signature);
  signature.trusted_comment = lines[2].substr(kTrusted.size());
  take(from_base64(lines[3], signature.global_signature.size(), name, "signature"), 0, signature.global_signature);
  return signature;
}

std::string format_signature_file(const MinisignSignature& signature) {
  Bytes bytes = {'E', static_cast<std::uint8_t>(signature.prehashed ? 'D' : 'd')};
  bytes.insert(bytes.end(), signature.key_id.begin(), signature.key_id.end());
  bytes.insert(bytes.end(), signature.signature.begin(), signature.signature.end());
  return std::string(kUntrusted) + "signature from pilotage\n" + to_base64(bytes) + "\n" + std::string(kTrusted) +
         signature.trusted_comment + "\n" + to_base64(signature.global_signature) + "\n";
}

}  // namespace pilotage
