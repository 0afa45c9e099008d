#pragma once

#include <filesystem>

#pragma GCC visibility push(default)

namespace pilotage {

/// A hidden folder ".pilotage-<machine>-XXXXXX" in which outputs grow, on the same disk as the place where they will
/// stand. It is locked (flock) while the object lives and removed with everything in it when the object dies. Folders
/// of this name beside it that nobody holds are leftovers of runs that were killed; they are removed when one is made
/// (those of other machines, whose locks may not be seen, a week after they were written).
class WorkFolder {
 public:
  /// Throws DataError beginning with `parent` when no folder can be made there.
  explicit WorkFolder(const std::filesystem::path& parent);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace pilotage

#pragma GCC visibility pop
