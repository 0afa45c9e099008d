#include "pilotage/base/file_digest.h"

#include <array>
#include <fstream>
#include <vector>

#include <sodium.h>

#include "pilotage/base/error.h"

namespace pilotage {

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
  std::array<unsigned char, 32> digest{};
  crypto_generichash_final(&state, digest.data(), digest.size());
  std::array<char, 65> hex{};
  sodium_bin2hex(hex.data(), hex.size(), digest.data(), digest.size());
  return hex.data();
}

}  // namespace pilotage
