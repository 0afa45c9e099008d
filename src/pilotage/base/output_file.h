#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "pilotage/base/read_file.h"
#include "pilotage/base/work_folder.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// An output that appears complete or not at all: it is written in a hidden folder beside its destination and renamed
/// by commit(). Without commit() the destructor removes what was written.
class OutputFile {
 public:
  /// Refuses an existing destination unless `overwrite`, and always one that is no regular file: a device, FIFO, socket
  /// or symbolic link would be replaced by a file. The folder must exist. Throws DataError.
  OutputFile(std::filesystem::path destination, bool overwrite);

  /// Where to write until commit(); does not exist yet. Has the destination's name.
  const std::filesystem::path& temporary_path() const { return temporary_; }
  const std::filesystem::path& destination() const { return destination_; }

  /// Writes the whole content to temporary_path(). Throws DataError.
  void write(std::string_view content);

  /// Syncs the file to disk, gives it the mode of the file that it replaces, renames it to the destination and syncs
  /// the folder. Throws DataError; what stood there before then still stands there.
  void commit();

  /// The same of several outputs that belong together, such as a map and its signature: see replace_together.
  static void commit(const std::vector<const OutputFile*>& outputs, const std::vector<std::filesystem::path>& stale);

 private:
  std::filesystem::path destination_;
  WorkFolder work_;
  std::filesystem::path temporary_;
};

/// A file that is whole, and where it is to stand.
struct FileMove {
  std::filesystem::path from;
  std::filesystem::path to;
};

/// Syncs files to disk and moves them to their places so that at no moment an old file stands beside a new one: first
/// all that stands there is moved into the folder `aside` (destinations, the last first, then the `stale` files that
/// have no successor), then the new files come, in their order. A run that is killed in between leaves some of the old
/// files or some of the new, never a mixture, and the last of them only where all others stand. When a file cannot be
/// moved, everything is put back and DataError is thrown.
void replace_together(const std::vector<FileMove>& moves, const std::vector<std::filesystem::path>& stale,
                      const std::filesystem::path& aside);

/// Writes `content` to `destination` through an OutputFile. Throws DataError.
void write_file(const std::filesystem::path& destination, std::string_view content, bool overwrite);

/// Throws DataError when something that is no regular file stands at `destination`; a symbolic link is none.
void refuse_special_file(const std::filesystem::path& destination);

}  // namespace pilotage

#pragma GCC visibility pop
