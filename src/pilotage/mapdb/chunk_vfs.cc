#include "pilotage/mapdb/chunk_vfs.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <new>

#include <sqlite3.h>

namespace pilotage {
namespace {

constexpr std::size_t kChunksKept = 64;     // 4 MiB
constexpr int kAskForFailure = 0x50494C4F;  // SQLite leaves operations above 100 to others; "PILO"

/// What SQLite allocates for an open file.
struct OpenFile {
  sqlite3_file base;
  ChunkVfs* vfs;
};

ChunkVfs& vfs_of(sqlite3_file* file) {
  return *reinterpret_cast<OpenFile*>(file)->vfs;
}

int read_file_bytes(sqlite3_file* file, void* to, int count, sqlite3_int64 offset) {
  ChunkVfs& vfs = vfs_of(file);
  const auto begin = static_cast<std::uint64_t>(offset);
  const auto wanted = static_cast<std::uint64_t>(count);
  const std::uint64_t there = begin < vfs.file().size() ? std::min(wanted, vfs.file().size() - begin) : 0;
  try {
    vfs.read(static_cast<char*>(to), begin, there);
  } catch (const std::bad_alloc&) {
    return SQLITE_IOERR_NOMEM;
  } catch (...) {
    vfs.failure = std::current_exception();
    return SQLITE_IOERR_READ;
  }
  if (there == wanted) return SQLITE_OK;
  std::memset(static_cast<char*>(to) + there, 0, static_cast<std::size_t>(wanted - there));  // as SQLite asks
  return SQLITE_IOERR_SHORT_READ;
}

int control(sqlite3_file* file, int operation, void* argument) {
  if (operation != kAskForFailure) return SQLITE_NOTFOUND;
  *static_cast<std::exception_ptr*>(argument) = std::exchange(vfs_of(file).failure, nullptr);
  return SQLITE_OK;
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
  *size = static_cast<sqlite3_int64>(vfs_of(file).file().size());
  return SQLITE_OK;
}

const sqlite3_io_methods& methods() {
  static const sqlite3_io_methods kMethods = [] {
    sqlite3_io_methods m{};
    m.iVersion = 1;
    m.xClose = [](sqlite3_file*) { return SQLITE_OK; };
    m.xRead = read_file_bytes;
    m.xWrite = [](sqlite3_file*, const void*, int, sqlite3_int64) { return SQLITE_READONLY; };
    m.xTruncate = [](sqlite3_file*, sqlite3_int64) { return SQLITE_READONLY; };
    m.xSync = [](sqlite3_file*, int) { return SQLITE_OK; };
    m.xFileSize = file_size;
    m.xLock = [](sqlite3_file*, int) { return SQLITE_OK; };
    m.xUnlock = [](sqlite3_file*, int) { return SQLITE_OK; };
    m.xCheckReservedLock = [](sqlite3_file*, int* locked) {
      *locked = 0;
      return SQLITE_OK;
    };
    m.xFileControl = control;
    m.xSectorSize = [](sqlite3_file*) { return 4096; };
    m.xDeviceCharacteristics = [](sqlite3_file*) { return SQLITE_IOCAP_IMMUTABLE; };
    return m;
  }();
  return kMethods;
}

int open_file(sqlite3_vfs* vfs, const char*, sqlite3_file* file, int flags, int* out_flags) {
  file->pMethods = nullptr;
  if ((flags & SQLITE_OPEN_MAIN_DB) == 0 || (flags & SQLITE_OPEN_READONLY) == 0) return SQLITE_CANTOPEN;
  auto* const opened = reinterpret_cast<OpenFile*>(file);
  opened->vfs = static_cast<ChunkVfs*>(vfs->pAppData);
  opened->base.pMethods = &methods();
  if (out_flags != nullptr) *out_flags = flags;
  return SQLITE_OK;
}

/// The system's own file system: for the clock and the like.
sqlite3_vfs* system_vfs() {
  return sqlite3_vfs_find(nullptr);
}

sqlite3_vfs make_vfs(const std::string& name, ChunkVfs* owner) {
  sqlite3_vfs vfs{};
  vfs.iVersion = 1;
  vfs.szOsFile = sizeof(OpenFile);
  vfs.mxPathname = 512;
  vfs.zName = name.c_str();
  vfs.pAppData = owner;
  vfs.xOpen = open_file;
  vfs.xDelete = [](sqlite3_vfs*, const char*, int) { return SQLITE_READONLY; };
  vfs.xAccess = [](sqlite3_vfs*, const char*, int, int* result) {
    *result = 0;  // there is no journal
    return SQLITE_OK;
  };
  vfs.xFullPathname = [](sqlite3_vfs*, const char* path, int size, char* full) {
    return std::snprintf(full, static_cast<std::size_t>(size), "%s", path) < size ? SQLITE_OK : SQLITE_CANTOPEN;
  };
  vfs.xRandomness = [](sqlite3_vfs*, int size, char* to) { return system_vfs()->xRandomness(system_vfs(), size, to); };
  vfs.xSleep = [](sqlite3_vfs*, int microseconds) { return system_vfs()->xSleep(system_vfs(), microseconds); };
  vfs.xCurrentTime = [](sqlite3_vfs*, double* day) { return system_vfs()->xCurrentTime(system_vfs(), day); };
  vfs.xGetLastError = [](sqlite3_vfs*, int, char*) { return 0; };
  return vfs;
}

/// Names of registered file systems must differ.
std::string unique_name(const void* object) {
  std::array<char, 64> name{};
  std::snprintf(name.data(), name.size(), "pilotage-chunks-%p", object);
  return name.data();
}

}  // namespace

ChunkVfs::ChunkVfs(std::shared_ptr<const ChunkedFile> file)
    : file_(std::move(file)), name_(unique_name(this)), vfs_(std::make_unique<sqlite3_vfs>(make_vfs(name_, this))) {
  if (sqlite3_vfs_register(vfs_.get(), 0) != SQLITE_OK) throw std::bad_alloc();
}

ChunkVfs::~ChunkVfs() {
  sqlite3_vfs_unregister(vfs_.get());
}

const std::string& ChunkVfs::chunk(std::uint64_t index) {
  const auto held = places_.find(index);
  if (held != places_.end()) {
    chunks_.splice(chunks_.begin(), chunks_, held->second);
    return chunks_.front().second;
  }
  std::string bytes = file_->read_chunk(index);
  if (chunks_.size() >= kChunksKept) {
    places_.erase(chunks_.back().first);
    chunks_.pop_back();
  }
  chunks_.emplace_front(index, std::move(bytes));
  places_[index] = chunks_.begin();
  return chunks_.front().second;
}

void ChunkVfs::read(char* to, std::uint64_t offset, std::uint64_t count) {
  while (count > 0) {
    const std::string& bytes = chunk(offset / kChunkBytes);
    const std::uint64_t at = offset % kChunkBytes;
    const std::uint64_t piece = std::min<std::uint64_t>(count, bytes.size() - at);
    std::memcpy(to, bytes.data() + at, static_cast<std::size_t>(piece));
    to += piece;
    offset += piece;
    count -= piece;
  }
}

void rethrow_chunk_failure(sqlite3* database) {
  std::exception_ptr failure;
  if (sqlite3_file_control(database, "main", kAskForFailure, &failure) == SQLITE_OK && failure) {
    std::rethrow_exception(failure);
  }
}

}  // namespace pilotage
