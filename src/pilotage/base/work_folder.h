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
  /// `parent_is_new`: the parent was made for this run, and goes with the folder when nothing else is in it. Throws
  /// DataError beginning with `parent` when no folder can be made there.
  explicit WorkFolder(const std::filesystem::path& parent, bool parent_is_new = false);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  void make_in(const std::filesystem::path& parent);

  std::filesystem::path path_;
  bool parent_is_new_;
  int lock_ = -1;
};

/// While one lives, abandon_work_folders() waits: files are being moved out of a work folder to where they stand.
class MovingOutputs {
 public:
  MovingOutputs();
  ~MovingOutputs();
  MovingOutputs(const MovingOutputs&) = delete;
  MovingOutputs& operator=(const MovingOutputs&) = delete;
};

/// Removes every WorkFolder of this process, whatever other threads do in them. From then on none is made and nothing
/// moves out of one: who tries waits for ever. For a process that ends next, and cannot wait for its threads.
void abandon_work_folders();

}  // namespace pilotage

#pragma GCC visibility pop
