#include "pilotage/base/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// `path`: a file or a folder; `named`: what a message calls it.
void sync_to_disk(const fs::path& path, const fs::path& named) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw DataError(named.string() + ": cannot be opened: " + std::strerror(errno));
  const int result = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  // Some file systems sync no folders; they say so with EINVAL.
  if (result != 0 && error != EINVAL) {
    throw DataError(named.string() + ": cannot be written to disk: " + std::strerror(error));
  }
}

std::vector<fs::path> folders_of(const std::vector<fs::path>& files) {
  std::vector<fs::path> folders;
  for (const fs::path& file : files) {
    if (std::find(folders.begin(), folders.end(), folder_of(file)) == folders.end()) folders.push_back(folder_of(file));
  }
  return folders;
}

void sync_folders(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) sync_to_disk(folder, folder);
}

void keep_mode(const fs::path& destination, const fs::path& replacement) {
  std::error_code error;
  const fs::file_status old = fs::symlink_status(destination, error);
  if (fs::is_regular_file(old)) fs::permissions(replacement, old.permissions(), error);
}

/// The checks before anything is made.
fs::path checked_destination(fs::path destination, bool overwrite) {
  std::error_code ignored;
  const fs::path folder = folder_of(destination);
  if (!fs::is_directory(folder, ignored)) {
    throw DataError(destination.string() + ": the folder " + folder.string() + " does not exist");
  }
  if (fs::is_directory(destination, ignored)) throw DataError(destination.string() + ": is a folder");
  refuse_special_file(destination);
  if (!overwrite && fs::exists(destination, ignored)) {
    throw DataError(destination.string() + ": exists already; give --overwrite to replace it");
  }
  return destination;
}

/// Renames that can be taken back.
class Renames {
 public:
  void rename(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::rename(from, to, error);
    if (!error) return done_.push_back({from, to});
    take_back();
    throw DataError(to.string() + ": cannot be created: " + error.message());
  }
  void take_back() {
    std::error_code ignored;
    for (auto move = done_.rbegin(); move != done_.rend(); ++move) fs::rename(move->to, move->from, ignored);
    done_.clear();
  }

 private:
  std::vector<FileMove> done_;
};

}  // namespace

void refuse_special_file(const fs::path& destination) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(destination, error);
  if (!fs::exists(status) || fs::is_regular_file(status)) return;
  throw DataError(destination.string() + ": is " +
                  (fs::is_symlink(status) ? "a symbolic link" : "a device, pipe or folder") +
                  ", which is not replaced by a file; name a regular file");
}

OutputFile::OutputFile(fs::path destination, bool overwrite)
    : destination_(checked_destination(std::move(destination), overwrite)),
      work_(folder_of(destination_)),
      temporary_(work_.path() / destination_.filename()) {}

void OutputFile::commit() {
  sync_to_disk(temporary_, destination_);
  keep_mode(destination_, temporary_);
  std::error_code error;
  const MovingOutputs moving;
  fs::rename(temporary_, destination_, error);
  if (error) throw DataError(destination_.string() + ": cannot be created: " + error.message());
  sync_folders({folder_of(destination_)});
}

void OutputFile::commit(const std::vector<const OutputFile*>& outputs, const std::vector<fs::path>& stale) {
  std::vector<FileMove> moves;
  for (const OutputFile* output : outputs) moves.push_back({output->temporary_, output->destination_});
  const WorkFolder aside(folder_of(outputs.front()->destination_));
  replace_together(moves, stale, aside.path());
}

void replace_together(const std::vector<FileMove>& moves, const std::vector<fs::path>& stale, const fs::path& aside) {
  std::vector<fs::path> old;
  std::vector<fs::path> all;
  for (const FileMove& move : moves) {
    refuse_special_file(move.to);
    sync_to_disk(move.from, move.to);
    keep_mode(move.to, move.from);
    all.insert(all.begin(), move.to);  // what comes last leaves first
  }
  all.insert(all.end(), stale.begin(), stale.end());
  for (const fs::path& path : all) {
    std::error_code ignored;
    if (fs::exists(fs::symlink_status(path, ignored)) && std::find(old.begin(), old.end(), path) == old.end()) {
      old.push_back(path);
    }
  }
  const MovingOutputs moving;
  Renames renames;
  std::size_t number = 0;
  for (const fs::path& path : old) renames.rename(path, aside / ("old-" + std::to_string(number++)));
  std::vector<fs::path> folders = folders_of(all);
  try {
    // Each folder reaches the disk by itself: old files must be gone from all of them before a new one comes to any.
    if (folders.size() > 1 && !old.empty()) sync_folders(folders);
    for (const FileMove& move : moves) renames.rename(move.from, move.to);
    std::reverse(folders.begin(), folders.end());  // that of the last file last
    sync_folders(folders);
  } catch (const DataError&) {
    renames.take_back();
    throw;
  }
}

void OutputFile::write(std::string_view content) {
  std::ofstream stream(temporary_, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.flush();
  if (!stream) throw DataError(destination_.string() + ": cannot be written: " + std::strerror(errno));
}

void write_file(const fs::path& destination, std::string_view content, bool overwrite) {
  OutputFile output(destination, overwrite);
  output.write(content);
  output.commit();
}

}  // namespace pilotage
