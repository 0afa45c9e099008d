#include "pilotage/mapdb/map_signing.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <vector>

#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/byte_order.h"
#include "pilotage/mapdb/chunked_file.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/mapdb/minisign_secret_key.h"
#include "pilotage/mapdb/trusted_signature.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxSecretKeyBytes = 64 * 1024;
constexpr std::size_t kMaxCommentBytes = 8000;  // minisign refuses lines of more than 8192 bytes

/// What is signed of a file, from one pass over it.
struct FileHashes {
  std::uint64_t size = 0;
  std::string whole;       ///< BLAKE2b-512, 64 bytes.
  std::string chunk_list;  ///< schemas/map-chunks.md
};

FileHashes hash_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || fs::is_directory(path)) throw DataError(path.string() + ": cannot be read");
  crypto_generichash_state state{};
  crypto_generichash_init(&state, nullptr, 0, crypto_generichash_BYTES_MAX);
  FileHashes hashes;
  std::string digests;
  std::string chunk(kChunkBytes, '\0');
  while (stream) {
    stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    const auto got = static_cast<std::size_t>(stream.gcount());
    if (got == 0) break;
    const std::string_view bytes(chunk.data(), got);
    crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    const auto digest = blake2b_256(bytes);
    digests.append(digest.begin(), digest.end());
    hashes.size += got;
  }
  if (stream.bad()) throw DataError(path.string() + ": cannot be read");
  hashes.whole.resize(crypto_generichash_BYTES_MAX);
  crypto_generichash_final(&state, reinterpret_cast<unsigned char*>(hashes.whole.data()), hashes.whole.size());
  std::vector<std::uint8_t> header;
  append_text(header, kChunkListMagic);
  append_le(header, hashes.size);
  hashes.chunk_list = std::string(header.begin(), header.end()) + digests;
  return hashes;
}

std::array<std::uint8_t, 64> sign(const std::string& message, const MinisignSecretKey& key) {
  std::array<std::uint8_t, 64> signature{};
  crypto_sign_detached(signature.data(), nullptr, reinterpret_cast<const unsigned char*>(message.data()),
                       message.size(), key.key.data());
  return signature;
}

MinisignSecretKey read_secret_key(const fs::path& path, const std::optional<std::string>& passphrase) {
  if (sodium_init() < 0) throw DataError("libsodium cannot be started");
  return parse_secret_key(read_file(path, kMaxSecretKeyBytes), passphrase, path.string());
}

void check_comment(const std::string& comment) {
  const bool one_line = std::none_of(comment.begin(), comment.end(),
                                     [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; });
  if (!one_line || comment.size() > kMaxCommentBytes) {
    throw UsageError("trusted_comment: must be one line of at most " + std::to_string(kMaxCommentBytes) + " bytes");
  }
}

}  // namespace

void check_secret_key(const fs::path& secret_key_path, const std::optional<std::string>& passphrase) {
  read_secret_key(secret_key_path, passphrase);
}

SignatureFiles sign_file(const fs::path& path, const fs::path& secret_key_path, const SignOptions& options) {
  std::string comment = options.trusted_comment.value_or("file:" + path.filename().string() + "\thashed");
  check_comment(comment);
  const MinisignSecretKey key = read_secret_key(secret_key_path, options.passphrase);
  const FileHashes hashes = hash_file(path);
  const bool with_list = hashes.size > options.chunk_list_above_bytes;
  if (with_list) comment += "\t" + chunk_list_mark(hashes.chunk_list);
  MinisignSignature signature;
  signature.key_id = key.key_id;
  signature.signature = sign(hashes.whole, key);
  signature.trusted_comment = comment;
  signature.global_signature = sign(minisign_global_message(signature), key);

  OutputFile signature_file(options.signature_path.value_or(signature_path_of(path)), options.overwrite);
  OutputFile list_file(options.chunk_list_path.value_or(chunk_list_path_of(path)), options.overwrite);
  signature_file.write(format_signature_file(signature));
  if (!with_list) {
    OutputFile::commit({&signature_file}, {list_file.destination()});
    return {signature_file.destination(), std::nullopt};
  }
  list_file.write(hashes.chunk_list);
  OutputFile::commit({&list_file, &signature_file}, {});
  return {signature_file.destination(), list_file.destination()};
}

void sign_whole_file(const fs::path& path, const fs::path& signature, const fs::path& secret_key_path,
                     SignOptions options) {
  options.signature_path = signature;
  options.chunk_list_path = std::nullopt;
  options.chunk_list_above_bytes = kNoChunkList;
  sign_file(path, secret_key_path, options);
}

}  // namespace pilotage
