#pragma once

#include <filesystem>
#include <string_view>

#include "pilotage/base/read_file.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// An output that appears complete or not at all: it is written under a temporary name in the same folder and renamed
/// by commit(). Without commit() the destructor removes what was written.
class OutputFile {
 public:
  /// Refuses an existing destination unless `overwrite`; the folder must exist. Throws DataError.
  OutputFile(std::filesystem::path destination, bool overwrite);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Where to write until commit(); does not exist yet. Keeps the destination's extension.
  const std::filesystem::path& temporary_path() const { return temporary_; }
  const std::filesystem::path& destination() const { return destination_; }

  /// Writes the whole content to temporary_path(). Throws DataError.
  void write(std::string_view content);

  /// Syncs the file to disk and renames it to the destination. Throws DataError.
  void commit();

 private:
  std::filesystem::path destination_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// Writes `content` to `destination` through an OutputFile. Throws DataError.
void write_file(const std::filesystem::path& destination, std::string_view content, bool overwrite);

}  // namespace pilotage

#pragma GCC visibility pop
