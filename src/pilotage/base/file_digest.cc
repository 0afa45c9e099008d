#include "pilotage/base/file_digest.h"

#include <array>
#include <fstream>
#include <vector>

#include <sodium.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using DigestBytes = std::array<unsigned char, 32>;

std::string to_hex(const DigestBytes& digest) {
  std::array<char, 65> hex{};
  sodium_bin2hex(hex.data(), hex.size(), digest.data(), digest.size());
  return hex.data();
}

}  // namespace

std::string bytes_digest(std::string_view bytes) {
  if (sodium_init() < 0) throw DataError("libsodium cannot be initialised");
  DigestBytes digest{};
  crypto_generichash(digest.data(), digest.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                     nullptr, 0);
  return to_hex(digest);
}

std::string file_digest(const std::filesystem::path& path) {
  if (sodium_init() < 0) throw DataError("libsodium cannot be initialised");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw DataError(path.string() + ": cannot be read");
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, 32);
  std::vector<char> piece(std::size_t{1} << 20);
  while (stream) {
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(piece.data()),
                              static_cast<unsigned long long>(stream.gcount()));
  }
  if (stream.bad()) throw DataError(path.string() + ": cannot be read");
  DigestBytes digest{};
  crypto_generichash_final(&state, digest.data(), digest.size());
  return to_hex(digest);
}

}  // namespace pilotage
