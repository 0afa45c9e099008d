#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pilotage {

/// Several outputs that appear together or not at all: they grow in a hidden folder inside the output folder and move
/// out at the end. What has not moved when the object dies is removed.
class StagingFolder {
 public:
  /// Makes the output folder when it does not exist; one that stays empty goes again. Throws DataError.
  explicit StagingFolder(const std::filesystem::path& output_folder);
  ~StagingFolder();
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  /// Where to write the output of this name until publish().
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// Moves the outputs into the output folder, over what stands there. Throws DataError.
  void publish(const std::vector<std::string>& names) const;

 private:
  std::filesystem::path output_folder_;
  std::filesystem::path path_;
  bool made_output_folder_ = false;
};

}  // namespace pilotage
