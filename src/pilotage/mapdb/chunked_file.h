#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace pilotage {

// A list of the digests of a file's chunks, and a file that is checked against one chunk by chunk
// (schemas/map-chunks.md): what makes it possible to trust a file that does not fit into memory.

inline constexpr std::size_t kChunkBytes = 65536;  ///< The last chunk of a file may be shorter.
inline constexpr std::size_t kChunkDigestBytes = 32;
inline constexpr std::string_view kChunkListMagic = "PilotageChunks1\n";
inline constexpr std::size_t kChunkListHeaderBytes = 24;  ///< The magic, and the size of the file as 64 bits.

/// How many chunks a file has.
constexpr std::uint64_t chunk_count(std::uint64_t file_bytes) {
  return file_bytes / kChunkBytes + (file_bytes % kChunkBytes > 0 ? 1 : 0);
}

/// What a trusted comment says of the list: "chunks:" and the BLAKE2b-256 of its bytes in hex.
std::string chunk_list_mark(const std::string& list);

/// A file whose bytes are checked whenever they are read. Any number of threads may read.
class ChunkedFile {
 public:
  /// `list`: the bytes of the list, which somebody trusted said are these. Throws DataError when the file cannot be
  /// read, or the list is none; IntegrityError when the file has another size than the list says.
  ChunkedFile(const std::filesystem::path& path, const std::string& list_name, std::string list);
  ~ChunkedFile();
  ChunkedFile(const ChunkedFile&) = delete;
  ChunkedFile& operator=(const ChunkedFile&) = delete;

  std::uint64_t size() const { return size_; }

  /// Reads chunk `index`, below chunk_count(size()), into memory of ours and checks it there, so that nothing lies
  /// between check and use. Throws IntegrityError when its bytes are not those of the list, DataError when it cannot be
  /// read.
  std::string read_chunk(std::uint64_t index) const;

 private:
  std::string name_;
  std::string list_;
  std::uint64_t size_ = 0;
  int descriptor_ = -1;
};

}  // namespace pilotage
