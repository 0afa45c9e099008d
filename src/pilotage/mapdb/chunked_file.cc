#include "pilotage/mapdb/chunked_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/byte_order.h"
#include "pilotage/mapdb/trusted_signature.h"

namespace pilotage {
namespace {

const std::uint8_t* as_bytes(const std::string& text) {
  return reinterpret_cast<const std::uint8_t*>(text.data());
}

/// The size of the file that a list is of.
std::uint64_t listed_size(const std::string& name, const std::string& list) {
  if (list.size() < kChunkListHeaderBytes || !list.starts_with(kChunkListMagic)) {
    throw DataError(name + ": is not a list of chunks");
  }
  const auto size = read_le<std::uint64_t>(as_bytes(list) + kChunkListMagic.size());
  const std::uint64_t listed = (list.size() - kChunkListHeaderBytes) / kChunkDigestBytes;
  if (list.size() != kChunkListHeaderBytes + listed * kChunkDigestBytes || listed != chunk_count(size)) {
    throw DataError(name + ": has " + std::to_string(list.size()) + " bytes, which is not the length of a list for " +
                    std::to_string(size) + " bytes");
  }
  return size;
}

}  // namespace

std::string chunk_list_mark(const std::string& list) {
  const auto digest = blake2b_256(list);
  std::array<char, 2 * kChunkDigestBytes + 1> hex{};
  sodium_bin2hex(hex.data(), hex.size(), digest.data(), digest.size());
  return std::string("chunks:") + hex.data();
}

ChunkedFile::ChunkedFile(const std::filesystem::path& path, const std::string& list_name, std::string list)
    : name_(path.string()), list_(std::move(list)), size_(listed_size(list_name, list_)) {
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe is refused below, not waited for
  if (descriptor_ < 0) throw DataError(name_ + ": cannot be read: " + std::strerror(errno));
  struct stat status {};
  const bool known = ::fstat(descriptor_, &status) == 0;
  const bool regular = known && S_ISREG(status.st_mode);
  if (regular && static_cast<std::uint64_t>(status.st_size) == size_) return;
  ::close(descriptor_);
  if (!regular) throw DataError(name_ + ": is not a regular file");
  throw IntegrityError(name_ + ": has " + std::to_string(status.st_size) + " bytes, signed were " +
                       std::to_string(size_) + ": take a fresh copy");
}

ChunkedFile::~ChunkedFile() {
  ::close(descriptor_);
}

std::string ChunkedFile::read_chunk(std::uint64_t index) const {
  const std::uint64_t begin = index * kChunkBytes;
  std::string chunk(static_cast<std::size_t>(std::min<std::uint64_t>(kChunkBytes, size_ - begin)), '\0');
  std::size_t done = 0;
  while (done < chunk.size()) {
    const ssize_t got =
        ::pread(descriptor_, chunk.data() + done, chunk.size() - done, static_cast<off_t>(begin + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw DataError(name_ + ": cannot be read: " + std::strerror(errno));
    if (got == 0) throw IntegrityError(name_ + ": became shorter while it was read: take a fresh copy");
    done += static_cast<std::size_t>(got);
  }
  const auto digest = blake2b_256(chunk);
  const std::uint8_t* const listed = as_bytes(list_) + kChunkListHeaderBytes + index * kChunkDigestBytes;
  if (!std::equal(digest.begin(), digest.end(), listed)) {
    throw IntegrityError(name_ + ": bytes " + std::to_string(begin) + " to " +
                         std::to_string(begin + chunk.size() - 1) +
                         " are not those that were signed: take a fresh copy");
  }
  return chunk;
}

}  // namespace pilotage
