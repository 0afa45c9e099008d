#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "pilotage/capture/frame_features.h"
#include "pilotage/capture/frame_pairs.h"

namespace pilotage {

/// Of one frame with others, by the digests of their files; without any match where they show nothing in common.
using MatchesWith = std::map<std::string, FeatureMatches>;

/// A folder that keeps what was found in pictures and in pairs of them, as it is found, so that a run that was stopped
/// goes on from there and several machines share the work (docs/scale.md). Files are told by the digests of the
/// pictures, not by names, places or options, none of which changes what is found; each ends in a digest of its own.
/// What is damaged, or was made by another version of the program, counts as not there and is replaced. Calls may
/// overlap, also from several processes: whichever is last wins, and all of them write the same.
class MatchFolder {
 public:
  /// Makes the folder when it is missing. Throws DataError when it cannot.
  MatchFolder(std::filesystem::path folder, std::string software_version);

  std::optional<FramePicture> find_picture(const std::string& digest);
  /// Throws DataError when it cannot be written; as does keep_matches.
  void keep_picture(const FramePicture& picture) const;

  /// Empty where there is nothing.
  MatchesWith find_matches(const std::string& digest_of_first);
  void keep_matches(const std::string& digest_of_first, const MatchesWith& matches) const;

  /// What to tell people of files that were found and could not be used; "" where there was none.
  std::string warning() const;

 private:
  std::optional<std::string> find(const std::filesystem::path& file, const std::string& magic);

  std::filesystem::path folder_;
  std::string software_version_;
  std::atomic<int> unusable_ = 0;
};

}  // namespace pilotage
