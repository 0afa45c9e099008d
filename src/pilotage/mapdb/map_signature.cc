#include "pilotage/mapdb/map_signature.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <vector>

#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/minisign_files.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxKeyFileBytes = 64 * 1024;
constexpr std::uintmax_t kMaxLegacyBytes = std::uintmax_t{1} << 31;
constexpr std::size_t kMaxCommentBytes = 8000;  // minisign refuses lines of more than 8192 bytes

void start_sodium() {
  if (sodium_init() < 0) throw DataError("libsodium cannot be started");
}

const unsigned char* bytes_of(const std::string& text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

/// BLAKE2b-512 of a file, as a string of 64 bytes.
std::string hash_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || fs::is_directory(path)) throw DataError(path.string() + ": cannot be read");
  crypto_generichash_state state{};
  crypto_generichash_init(&state, nullptr, 0, crypto_generichash_BYTES_MAX);
  std::string block(1 << 20, '\0');
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    crypto_generichash_update(&state, bytes_of(block), static_cast<unsigned long long>(stream.gcount()));
  }
  if (stream.bad()) throw DataError(path.string() + ": cannot be read");
  std::string hash(crypto_generichash_BYTES_MAX, '\0');
  crypto_generichash_final(&state, reinterpret_cast<unsigned char*>(hash.data()), hash.size());
  return hash;
}

std::array<std::uint8_t, 64> sign(const std::string& message, const MinisignSecretKey& key) {
  std::array<std::uint8_t, 64> signature{};
  crypto_sign_detached(signature.data(), nullptr, bytes_of(message), message.size(), key.key.data());
  return signature;
}

bool signed_by(const std::array<std::uint8_t, 64>& signature, const std::string& message,
               const MinisignPublicKey& key) {
  return crypto_sign_verify_detached(signature.data(), bytes_of(message), message.size(), key.key.data()) == 0;
}

/// What the global signature covers.
std::string global_message(const MinisignSignature& signature) {
  return std::string(signature.signature.begin(), signature.signature.end()) + signature.trusted_comment;
}

fs::path default_signature_path(const fs::path& path) {
  fs::path result = path;
  result += ".minisig";
  return result;
}

MinisignPublicKey load_public_key(const std::string& public_key) {
  const bool is_key = public_key.size() == 56 && public_key.starts_with("RW");
  std::error_code ignored;
  if (is_key && !fs::exists(public_key, ignored)) return parse_public_key(public_key, "public key");
  return parse_public_key(read_file(public_key, kMaxKeyFileBytes), public_key);
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
  start_sodium();
  const std::string comment = options.trusted_comment.value_or("file:" + path.filename().string() + "\thashed");
  check_comment(comment);
  const MinisignSecretKey key =
      parse_secret_key(read_file(secret_key_path, kMaxKeyFileBytes), options.passphrase, secret_key_path.string());
  MinisignSignature signature;
  signature.key_id = key.key_id;
  signature.signature = sign(hash_file(path), key);
  signature.trusted_comment = comment;
  signature.global_signature = sign(global_message(signature), key);
  const fs::path destination = options.signature_path.value_or(default_signature_path(path));
  write_file(destination, format_signature_file(signature), options.overwrite);
  return destination;
}

SignatureInfo verify_signature(const fs::path& path, const std::string& public_key,
                               const std::optional<fs::path>& signature_path) {
  start_sodium();
  const MinisignPublicKey key = load_public_key(public_key);
  const fs::path signature_file = signature_path.value_or(default_signature_path(path));
  const MinisignSignature signature =
      parse_signature(read_file(signature_file, kMaxKeyFileBytes), signature_file.string());
  if (signature.key_id != key.key_id) {
    throw IntegrityError(signature_file.string() + ": was made with key " + format_key_id(signature.key_id) +
                         ", not with " + format_key_id(key.key_id));
  }
  const std::string message = signature.prehashed ? hash_file(path) : read_file(path, kMaxLegacyBytes);
  if (!signed_by(signature.signature, message, key)) {
    throw IntegrityError(path.string() + ": the signature does not match the file");
  }
  if (!signed_by(signature.global_signature, global_message(signature), key)) {
    throw IntegrityError(signature_file.string() + ": the trusted comment was changed");
  }
  return {signature.trusted_comment, format_key_id(signature.key_id), signature.prehashed};
}

}  // namespace pilotage
