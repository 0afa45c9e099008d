#include "testing/key_pair.h"

#include <array>
#include <stdexcept>
#include <vector>

#include <sodium.h>

#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/byte_order.h"

namespace pilotage::testing {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string base64(const Bytes& bytes) {
  std::string text(sodium_base64_encoded_len(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(), sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // the terminating NUL
  return text;
}

template <class Part>
void append(Bytes& bytes, const Part& part) {
  bytes.insert(bytes.end(), part.begin(), part.end());
}

/// Key id, key and checksum: what a passphrase encrypts.
Bytes kept_secret(const MinisignSecretKey& key, bool with_checksum) {
  Bytes bytes;
  append(bytes, key.key_id);
  append(bytes, key.key);
  std::array<std::uint8_t, 32> checksum{};
  if (with_checksum) {  // BLAKE2b-256 over algorithm, key id and key
    Bytes covered{'E', 'd'};
    append(covered, bytes);
    crypto_generichash(checksum.data(), checksum.size(), covered.data(), covered.size(), nullptr, 0);
  }
  append(bytes, checksum);
  return bytes;
}

std::string secret_key_file(const Bytes& head, const Bytes& secret) {
  Bytes bytes = head;
  append(bytes, secret);
  return "untrusted comment: minisign encrypted secret key\n" + base64(bytes) + "\n";
}

}  // namespace

std::string encrypted_secret_key_file(const MinisignSecretKey& key, const std::string& passphrase,
                                      const ScryptCost& cost) {
  Bytes head{'E', 'd', 'S', 'c', 'B', '2'};
  Bytes salt(32);
  randombytes_buf(salt.data(), salt.size());
  append(head, salt);
  append_le(head, cost.operations);
  append_le(head, cost.memory_bytes);
  Bytes secret = kept_secret(key, true);
  Bytes stream(secret.size());
  if (crypto_pwhash_scryptsalsa208sha256(stream.data(), stream.size(), passphrase.data(), passphrase.size(),
                                         salt.data(), cost.operations,
                                         static_cast<std::size_t>(cost.memory_bytes)) != 0) {
    throw std::runtime_error("scrypt has not enough memory");
  }
  for (std::size_t i = 0; i < secret.size(); ++i) secret[i] = static_cast<std::uint8_t>(secret[i] ^ stream[i]);
  return secret_key_file(head, secret);
}

std::string generate_key_pair(const std::filesystem::path& secret_key_path,
                              const std::filesystem::path& public_key_path) {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be started");
  MinisignSecretKey secret;
  std::array<std::uint8_t, 32> public_key{};
  randombytes_buf(secret.key_id.data(), secret.key_id.size());
  crypto_sign_keypair(public_key.data(), secret.key.data());
  Bytes head{'E', 'd', 0, 0, 'B', '2'};
  head.resize(54);  // no salt, no cost
  write_file(secret_key_path, secret_key_file(head, kept_secret(secret, false)), false);
  Bytes shown{'E', 'd'};
  append(shown, secret.key_id);
  append(shown, public_key);
  write_file(public_key_path, "untrusted comment: minisign public key\n" + base64(shown) + "\n", false);
  return base64(shown);
}

}  // namespace pilotage::testing
