// A library for LD_PRELOAD that makes file calls of a program fail, one at a time and at will, and writes down what the
// program asks of the disk. Calls on files below one folder count; those of the dynamic loader or of PROJ do not.
//
//   FAULT_FOLDER   calls on files below it count; without it nothing does (absolute, no trailing slash)
//   FAULT_CALLS    which: a list of open, read, write, sync, rename, remove, alloc, separated by commas
//   FAULT_AT       the number of the call at which it happens, from 1; 0 or none: never
//   FAULT_ACTION   EIO, ENOSPC, EMFILE, EACCES …: the call fails with it; SHORT: reads and writes do a part; KILL:
//   SIGKILL FAULT_LASTS    1: the calls after that one fail as well (a full disk) FAULT_LOG      each call that counts
//   is a line of this file: number, tab, call, tab, path (and the second path) FAULT_DISK     what is synced is copied
//   here, as NUMBER of its line in the log: what a power cut would leave
//
// alloc counts allocations of 64 KiB and more, wherever they come from.

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

struct Setting {
  std::string folder;
  std::string calls;
  long at = 0;
  int error = 0;
  bool lasts = false;
  bool is_short = false;
  bool kills = false;
  int log = -1;
  std::string disk;
};

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

int error_number(const std::string& name) {
  for (int number = 1; number < 134; ++number) {
    const char* known = strerrorname_np(number);
    if (known != nullptr && name == known) return number;
  }
  return 0;
}

const Setting& setting() {
  static const Setting given = [] {
    Setting s;
    s.folder = environment("FAULT_FOLDER");
    s.calls = "," + environment("FAULT_CALLS") + ",";
    s.at = std::atol(environment("FAULT_AT").c_str());
    const std::string action = environment("FAULT_ACTION");
    s.kills = action == "KILL";
    s.is_short = action == "SHORT";
    s.error = error_number(action);
    s.lasts = environment("FAULT_LASTS") == "1";
    s.disk = environment("FAULT_DISK");
    const std::string log = environment("FAULT_LOG");
    if (!log.empty()) {
      s.log = static_cast<int>(
          ::syscall(SYS_openat, AT_FDCWD, log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
    }
    return s;
  }();
  return given;
}

std::atomic<long> counted{0};
/// The library's own work, and what is done before it is set up, never counts.
thread_local bool inside = true;
std::atomic<bool> ready{false};

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

bool is_below(std::string_view path, std::string_view folder) {
  return !folder.empty() && path.size() > folder.size() && path.substr(0, folder.size()) == folder &&
         path[folder.size()] == '/';
}

std::string absolute(const char* path) {
  if (path == nullptr) return "";
  if (path[0] == '/') return path;
  char folder[PATH_MAX];
  return ::getcwd(folder, sizeof(folder)) == nullptr ? path : std::string(folder) + "/" + path;
}

std::string path_of(int descriptor) {
  char name[64];
  std::snprintf(name, sizeof(name), "/proc/self/fd/%d", descriptor);
  char path[PATH_MAX];
  const ssize_t length = ::readlink(name, path, sizeof(path));
  return length < 0 ? "" : std::string(path, static_cast<std::size_t>(length));
}

void copy_file(const std::string& from, const std::string& to) {
  const int in = static_cast<int>(::syscall(SYS_openat, AT_FDCWD, from.c_str(), O_RDONLY | O_CLOEXEC));
  const int out =
      static_cast<int>(::syscall(SYS_openat, AT_FDCWD, to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  char buffer[1 << 16];
  long got = 0;
  while (in >= 0 && out >= 0 && (got = ::syscall(SYS_read, in, buffer, sizeof(buffer))) > 0) {
    if (::syscall(SYS_write, out, buffer, static_cast<std::size_t>(got)) != got) std::abort();
  }
  if (in >= 0) ::syscall(SYS_close, in);
  if (out >= 0) ::syscall(SYS_close, out);
}

enum class Verdict { kGoOn, kFail, kShort };

/// A call on a path: is it the one?
Verdict judge(const char* group, const char* call, const std::string& path, const std::string& second = {}) {
  const Setting& s = setting();
  if (s.calls.find(std::string(",") + group + ",") == std::string::npos) return Verdict::kGoOn;
  const bool is_alloc = std::strcmp(group, "alloc") == 0;
  if (!is_alloc && !is_below(path, s.folder) && path != s.folder) return Verdict::kGoOn;
  const long number = ++counted;
  if (s.log >= 0) {
    const std::string line =
        std::to_string(number) + "\t" + call + "\t" + path + (second.empty() ? "" : "\t" + second) + "\n";
    if (::syscall(SYS_write, s.log, line.data(), line.size()) < 0) std::abort();
  }
  if (s.at > 0 && (number == s.at || (s.lasts && number > s.at))) {
    if (s.kills) ::raise(SIGKILL);
    if (s.is_short) return Verdict::kShort;
    errno = s.error;
    return Verdict::kFail;
  }
  if (!s.disk.empty() && std::strcmp(group, "sync") == 0) copy_file(path, s.disk + "/" + std::to_string(number));
  return Verdict::kGoOn;
}

/// Lets the calls of `work` pass uncounted.
template <typename Work>
auto quietly(Work work) {
  const bool was = inside;
  inside = true;
  auto result = work();
  inside = was;
  return result;
}

bool counts() {
  return ready.load(std::memory_order_relaxed) && !inside;
}

Verdict judge_descriptor(const char* group, const char* call, int descriptor) {
  if (!counts()) return Verdict::kGoOn;
  return quietly([&] { return judge(group, call, path_of(descriptor)); });
}

Verdict judge_path(const char* group, const char* call, const char* path, const char* second = nullptr) {
  if (!counts()) return Verdict::kGoOn;
  return quietly([&] { return judge(group, call, absolute(path), second == nullptr ? "" : absolute(second)); });
}

std::size_t part_of(std::size_t size, Verdict verdict) {
  return verdict == Verdict::kShort && size > 1 ? size / 2 : size;
}

bool fails_to_allocate(std::size_t size) {
  return size >= 65536 && counts() && quietly([] { return judge("alloc", "malloc", ""); }) == Verdict::kFail;
}

__attribute__((constructor)) void start() {
  setting();
  ready = true;
}

/// `inside` starts true in every thread, so that the loader's and the C library's own set-up is left alone; the first
/// call that arrives after start() ends that.
struct Awake {
  Awake() {
    if (ready.load(std::memory_order_relaxed) && !awake) {
      awake = true;
      inside = false;
    }
  }
  static thread_local bool awake;
};
thread_local bool Awake::awake = false;

mode_t mode_of(int flags, va_list arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(arguments, int)) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  const Awake awake;
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  if (judge_path("open", "open", path) == Verdict::kFail) return -1;
  static auto* const real = next<int(const char*, int, ...)>("open");
  return real(path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
  const Awake awake;
  if (judge_path("open", "fopen", path) == Verdict::kFail) return nullptr;
  static auto* const real = next<FILE*(const char*, const char*)>("fopen");
  return real(path, mode);
}

// Where off_t has 64 bits these are the same functions.
static_assert(sizeof(off_t) == 8);
int open64(const char* path, int flags, ...) __attribute__((alias("open")));
FILE* fopen64(const char* path, const char* mode) __attribute__((alias("fopen")));

ssize_t read(int descriptor, void* buffer, size_t size) {
  const Awake awake;
  const Verdict verdict = judge_descriptor("read", "read", descriptor);
  if (verdict == Verdict::kFail) return -1;
  static auto* const real = next<ssize_t(int, void*, size_t)>("read");
  return real(descriptor, buffer, part_of(size, verdict));
}

ssize_t pread64(int descriptor, void* buffer, size_t size, off64_t offset) {
  const Awake awake;
  const Verdict verdict = judge_descriptor("read", "pread", descriptor);
  if (verdict == Verdict::kFail) return -1;
  static auto* const real = next<ssize_t(int, void*, size_t, off64_t)>("pread64");
  return real(descriptor, buffer, part_of(size, verdict), offset);
}

size_t fread(void* buffer, size_t size, size_t count, FILE* stream) {
  const Awake awake;
  const Verdict verdict = judge_descriptor("read", "fread", ::fileno(stream));
  static auto* const real = next<size_t(void*, size_t, size_t, FILE*)>("fread");
  if (verdict == Verdict::kFail) {
    stream->_flags |= 0x20;  // _IO_ERR_SEEN: what ferror() tells after a failed read
    return 0;
  }
  return real(buffer, size, part_of(count, verdict), stream);
}

ssize_t write(int descriptor, const void* buffer, size_t size) {
  const Awake awake;
  const Verdict verdict = judge_descriptor("write", "write", descriptor);
  if (verdict == Verdict::kFail) return -1;
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  return real(descriptor, buffer, part_of(size, verdict));
}

ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  const Awake awake;
  const Verdict verdict = judge_descriptor("write", "writev", descriptor);
  if (verdict == Verdict::kFail) return -1;
  static auto* const real = next<ssize_t(int, const struct iovec*, int)>("writev");
  return real(descriptor, parts, verdict == Verdict::kShort && count > 1 ? count - 1 : count);
}

ssize_t pwrite64(int descriptor, const void* buffer, size_t size, off64_t offset) {
  const Awake awake;
  const Verdict verdict = judge_descriptor("write", "pwrite", descriptor);
  if (verdict == Verdict::kFail) return -1;
  static auto* const real = next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64");
  return real(descriptor, buffer, part_of(size, verdict), offset);
}

size_t fwrite(const void* buffer, size_t size, size_t count, FILE* stream) {
  const Awake awake;
  const Verdict verdict = judge_descriptor("write", "fwrite", ::fileno(stream));
  if (verdict == Verdict::kFail) {
    stream->_flags |= 0x20;  // _IO_ERR_SEEN
    return 0;
  }
  static auto* const real = next<size_t(const void*, size_t, size_t, FILE*)>("fwrite");
  return real(buffer, size, part_of(count, verdict), stream);
}

int ftruncate64(int descriptor, off64_t size) {
  const Awake awake;
  if (judge_descriptor("write", "ftruncate", descriptor) == Verdict::kFail) return -1;
  static auto* const real = next<int(int, off64_t)>("ftruncate64");
  return real(descriptor, size);
}

int fsync(int descriptor) {
  const Awake awake;
  if (judge_descriptor("sync", "fsync", descriptor) == Verdict::kFail) return -1;
  static auto* const real = next<int(int)>("fsync");
  return real(descriptor);
}

int fdatasync(int descriptor) {
  const Awake awake;
  if (judge_descriptor("sync", "fdatasync", descriptor) == Verdict::kFail) return -1;
  static auto* const real = next<int(int)>("fdatasync");
  return real(descriptor);
}

int rename(const char* from, const char* to) {
  const Awake awake;
  if (judge_path("rename", "rename", from, to) == Verdict::kFail) return -1;
  static auto* const real = next<int(const char*, const char*)>("rename");
  return real(from, to);
}

int unlink(const char* path) {
  const Awake awake;
  if (judge_path("remove", "unlink", path) == Verdict::kFail) return -1;
  static auto* const real = next<int(const char*)>("unlink");
  return real(path);
}

int remove(const char* path) {
  const Awake awake;
  if (judge_path("remove", "remove", path) == Verdict::kFail) return -1;
  static auto* const real = next<int(const char*)>("remove");
  return real(path);
}

int unlinkat(int folder, const char* path, int flags) {
  const Awake awake;
  const Verdict verdict = !counts() ? Verdict::kGoOn : quietly([&] {
    return judge("remove", "unlinkat",
                 folder == AT_FDCWD || path[0] == '/' ? absolute(path) : path_of(folder) + "/" + path);
  });
  if (verdict == Verdict::kFail) return -1;
  static auto* const real = next<int(int, const char*, int)>("unlinkat");
  return real(folder, path, flags);
}

int mkdir(const char* path, mode_t mode) {
  const Awake awake;
  if (judge_path("open", "mkdir", path) == Verdict::kFail) return -1;
  static auto* const real = next<int(const char*, mode_t)>("mkdir");
  return real(path, mode);
}

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* block, size_t size);

void* malloc(size_t size) {
  if (fails_to_allocate(size)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_malloc(size);
}

void* calloc(size_t count, size_t size) {
  if (fails_to_allocate(count * size)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_calloc(count, size);
}

void* realloc(void* block, size_t size) {
  if (fails_to_allocate(size)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_realloc(block, size);
}

}  // extern "C"
