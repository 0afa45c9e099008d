#include "pilotage/base/work_folder.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr std::string_view kWorkPrefix = ".pilotage-";
constexpr std::size_t kBootDigits = 8;
constexpr std::ptrdiff_t kRandomLetters = 6;  // of mkdtemp
constexpr std::size_t kWorkNameLength = kWorkPrefix.size() + kBootDigits + 1 + std::size_t{kRandomLetters};

/// The locks of a folder on a network may be seen by the machines that share it, or not. What another machine (or this
/// one before it was started again) left is taken for dead after a time in which no run goes without writing.
constexpr auto kForeignLifetime = std::chrono::hours(7 * 24);

/// The same for all containers of a machine, another after each start of a machine.
std::string boot_digits() {
  std::string id(kBootDigits, '0');
  std::ifstream stream("/proc/sys/kernel/random/boot_id");
  stream.read(id.data(), static_cast<std::streamsize>(id.size()));
  return stream ? id : std::string(kBootDigits, '0');
}

bool may_be_dead(const std::filesystem::path& folder, const std::string& name) {
  if (name.substr(kWorkPrefix.size(), kBootDigits) == boot_digits()) return true;  // then its lock tells
  std::error_code error;
  const auto written = std::filesystem::last_write_time(folder, error);
  return !error && std::filesystem::file_time_type::clock::now() - written > kForeignLifetime;
}

/// The folder, open and locked, or -1 with errno: EWOULDBLOCK when another process holds it, others when there are no
/// locks.
int lock_folder(const std::filesystem::path& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
  if (folder < 0) return -1;
  if (::flock(folder, LOCK_EX | LOCK_NB) == 0) return folder;
  const int error = errno;
  ::close(folder);
  errno = error;
  return -1;
}

void remove_leftovers(const std::filesystem::path& parent) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
    const std::filesystem::path& path = entry->path();
    const std::string name = path.filename().string();
    if (name.size() != kWorkNameLength || !name.starts_with(kWorkPrefix)) continue;
    if (!may_be_dead(path, name)) continue;
    const int folder = lock_folder(path);
    if (folder < 0) continue;
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
    ::close(folder);
  }
}

/// Whether the open folder still stands at its path: another process may have taken it for a leftover before it was
/// locked.
bool stands(int folder, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat found {};
  return ::fstat(folder, &opened) == 0 && ::stat(path.c_str(), &found) == 0 && opened.st_ino == found.st_ino &&
         opened.st_dev == found.st_dev;
}

/// The folders of this process that stand, the latest last. Never destroyed: abandon_work_folders() may be called while
/// the process ends by itself.
struct Standing {
  struct Entry {
    std::filesystem::path path;
    bool parent_is_new;
  };
  std::mutex moving;  ///< Taken before `access` where both are.
  std::mutex access;
  std::vector<Entry> folders;
};

Standing& standing() {
  static auto* const all = new Standing;
  return *all;
}

void remove_new_parent(const std::filesystem::path& folder, bool parent_is_new) {
  std::error_code ignored;
  if (parent_is_new) std::filesystem::remove(folder.parent_path(), ignored);  // only when it is empty
}

/// Under another name first: who still makes files by the old one gets an error, and cannot keep the folder from going.
void remove_while_others_write(const std::filesystem::path& folder) {
  std::string name = folder.filename().string();
  std::reverse(name.end() - kRandomLetters, name.end());
  const std::filesystem::path other = folder.parent_path() / name;
  std::error_code error;
  std::filesystem::rename(folder, other, error);
  std::filesystem::remove_all(error ? folder : other, error);
}

}  // namespace

MovingOutputs::MovingOutputs() {
  standing().moving.lock();
}

MovingOutputs::~MovingOutputs() {
  standing().moving.unlock();
}

void abandon_work_folders() {
  Standing& all = standing();
  all.moving.lock();  // and neither is given back
  all.access.lock();
  for (auto folder = all.folders.rbegin(); folder != all.folders.rend(); ++folder) {
    remove_while_others_write(folder->path);
    remove_new_parent(folder->path, folder->parent_is_new);
  }
}

WorkFolder::WorkFolder(const std::filesystem::path& parent, bool parent_is_new) : parent_is_new_(parent_is_new) {
  remove_leftovers(parent);
  const std::lock_guard lock(standing().access);
  try {
    make_in(parent);
  } catch (...) {
    std::error_code ignored;
    if (parent_is_new) std::filesystem::remove(parent, ignored);
    throw;
  }
  standing().folders.push_back({path_, parent_is_new_});
}

void WorkFolder::make_in(const std::filesystem::path& parent) {
  constexpr int kAttempts = 10;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::string name = (parent / (std::string(kWorkPrefix) + boot_digits() + "-XXXXXX")).string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw DataError(parent.string() + ": nothing can be written there: " + std::strerror(errno));
    }
    path_ = name;
    lock_ = lock_folder(path_);
    const bool taken = lock_ < 0 ? errno == EWOULDBLOCK || errno == ENOENT : !stands(lock_, path_);
    if (!taken) return;
    if (lock_ >= 0) ::close(lock_);
  }
  throw DataError(parent.string() + ": no folder for unfinished outputs can be kept there");
}

WorkFolder::~WorkFolder() {
  const std::lock_guard lock(standing().access);
  std::erase_if(standing().folders, [&](const Standing::Entry& entry) { return entry.path == path_; });
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  remove_new_parent(path_, parent_is_new_);
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace pilotage
