#include "pilotage/mapdb/map_signing.h"

#include <algorithm>
#include <array>
#include <fstream>

#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/mapdb/minisign_secret_key.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxSecretKeyBytes = 64 * 1024;
constexpr std::size_t kMaxCommentBytes = 8000;  // minisign refuses lines of more than 8192 bytes

/// BLAKE2b-512 of a file, as a string of 64 bytes.
std::string hash_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || fs::is_directory(path)) throw DataError(path.string() + ": cannot be read");
  crypto_generichash_state state{};
  crypto_generichash_init(&state, nullptr, 0, crypto_generichash_BYTES_MAX);
  std::string block(1 << 20, '\0');
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(block.data()),
                              static_cast<unsigned long long>(stream.gcount()));
  }
  if (stream.bad()) throw DataError(path.string() + ": cannot be read");
  std::string hash(crypto_generichash_BYTES_MAX, '\0');
  crypto_generichash_final(&state, reinterpret_cast<unsigned char*>(hash.data()), hash.size());
  return hash;
}

std::array<std::uint8_t, 64> sign(const std::string& message, const MinisignSecretKey& key) {
  std::array<std::uint8_t, 64> signature{};
  crypto_sign_detached(signature.data(), nullptr, reinterpret_cast<const unsigned char*>(message.data()),
                       message.size(), key.key.data());
  return signature;
}

void check_comment(const std::string& comment) {
  const bool one_line = std::none_of(comment.begin(), comment.end(),
                                     [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; });
  if (!one_line || comment.size() > kMaxCommentBytes) {
    throw UsageError("trusted_comment: must be one line of at most " + std::to_string(kMaxCommentBytes) + " bytes");
  }
}

}  // namespace

fs::path sign_file(const fs::path& path, const fs::path& secret_key_path, const SignOptions& options) {
  if (sodium_init() < 0) throw DataError("libsodium cannot be started");
  const std::string comment = options.trusted_comment.value_or("file:" + path.filename().string() + "\thashed");
  check_comment(comment);
  const MinisignSecretKey key =
      parse_secret_key(read_file(secret_key_path, kMaxSecretKeyBytes), options.passphrase, secret_key_path.string());
  MinisignSignature signature;
  signature.key_id = key.key_id;
  signature.signature = sign(hash_file(path), key);
  signature.trusted_comment = comment;
  signature.global_signature = sign(minisign_global_message(signature), key);
  const fs::path destination = options.signature_path.value_or(signature_path_of(path));
  write_file(destination, format_signature_file(signature), options.overwrite);
  return destination;
}

}  // namespace pilotage
