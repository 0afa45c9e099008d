#include "pilotage/base/file_digest.h"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

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
  const auto fail = [&](const std::string& why) { throw DataError(path.string() + ": cannot be read: " + why); };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) fail(std::strerror(errno));
  const std::unique_ptr<const int, void (*)(const int*)> closed(&descriptor, [](const int* file) { ::close(*file); });
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) fail(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) fail("it is no regular file");
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, 32);
  std::vector<unsigned char> piece(std::size_t{1} << 20);
  std::int64_t total = 0;
  while (true) {
    const ssize_t got = ::read(descriptor, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(std::strerror(errno));
    if (got == 0) break;
    crypto_generichash_update(&state, piece.data(), static_cast<unsigned long long>(got));
    total += got;
  }
  // Some media end a file early without an error.
  if (total != status.st_size) {
    fail("it ends after " + std::to_string(total) + " of " + std::to_string(status.st_size) + " bytes");
  }
  DigestBytes digest{};
  crypto_generichash_final(&state, digest.data(), digest.size());
  return to_hex(digest);
}

}  // namespace pilotage
