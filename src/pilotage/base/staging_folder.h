#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/base/work_folder.h"

namespace pilotage {

class OutputFile;

/// Several outputs that belong together: they grow in a hidden folder inside the output folder and move out at the end.
/// What has not moved when the object dies is removed.
class StagingFolder {
 public:
  /// Makes the output folder when it does not exist; one that stays empty goes again. Throws DataError.
  explicit StagingFolder(const std::filesystem::path& output_folder);

  /// Where to write the output of this name until publish().
  std::filesystem::path operator/(const std::string& name) const;

  /// Moves the outputs into the output folder in this order, in place of those of the same names and of `stale`, names
  /// of an earlier run's outputs: at no moment an old output stands beside a new one (replace_together). Throws
  /// DataError; the earlier outputs then stand there again.
  /// `others` are outputs of the same run that have places of their own, and appear with these.
  void publish(const std::vector<std::string>& names, const std::vector<std::string>& stale,
               const std::vector<const OutputFile*>& others = {}) const;

 private:
  static bool make_folder(const std::filesystem::path& folder);

  std::filesystem::path output_folder_;
  WorkFolder work_;
};

}  // namespace pilotage
