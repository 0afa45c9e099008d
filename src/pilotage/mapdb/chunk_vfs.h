#pragma once

#include <cstdint>
#include <exception>
#include <list>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>

#include "pilotage/mapdb/chunked_file.h"

struct sqlite3;
struct sqlite3_vfs;

namespace pilotage {

/// The file system that one connection of SQLite sees (sqlite.org/vfs.html): a single file, which cannot be written and
/// whose bytes are checked chunk by chunk as they are read. Must outlive the connection.
class ChunkVfs {
 public:
  explicit ChunkVfs(std::shared_ptr<const ChunkedFile> file);
  ~ChunkVfs();
  ChunkVfs(const ChunkVfs&) = delete;
  ChunkVfs& operator=(const ChunkVfs&) = delete;

  const std::string& name() const { return name_; }  ///< As sqlite3_open_v2 wants it.

  /// Copies bytes of the file, which lie within it. Throws as ChunkedFile::read_chunk.
  void read(char* to, std::uint64_t offset, std::uint64_t count);

  const ChunkedFile& file() const { return *file_; }

  /// Why the last read failed; SQLite hands on numbers only.
  std::exception_ptr failure;

 private:
  const std::string& chunk(std::uint64_t index);

  std::shared_ptr<const ChunkedFile> file_;
  std::string name_;
  std::unique_ptr<sqlite3_vfs> vfs_;
  /// Checked chunks, lately used ones first.
  std::list<std::pair<std::uint64_t, std::string>> chunks_;
  std::unordered_map<std::uint64_t, std::list<std::pair<std::uint64_t, std::string>>::iterator> places_;
};

/// Throws why the connection's ChunkVfs could not read; returns when it could, or the connection has another file
/// system.
void rethrow_chunk_failure(sqlite3* database);

}  // namespace pilotage
