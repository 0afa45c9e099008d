#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "pilotage/capture/frame_features.h"
#include "pilotage/capture/frame_pairs.h"

namespace pilotage {

/// A folder that keeps the features of pictures and the matches of pairs, each as soon as it is found, so that a run
/// that was stopped goes on from there and several machines share the work (docs/scale.md). Features are told by the
/// digest of the picture as it was decoded, matches by those of the features that they join: neither names nor places
/// nor options matter. Every file ends in a digest of its own and begins with what made it: kMatchRevision and the
/// version of OpenCV. What is of others, damaged or cannot be read counts as not there and is replaced. Calls may
/// overlap, also from several processes: each writes whole files, and the last one stays.
class MatchFolder {
 public:
  /// Makes the folder when it is missing. Throws DataError when it cannot.
  explicit MatchFolder(std::filesystem::path folder);

  std::optional<FrameFeatures> find_features(const std::string& picture_digest);
  std::optional<FeatureMatches> find_matches(const FrameFeatures& first, const FrameFeatures& second);

  /// Sets FrameFeatures::digest, by which keep_matches() and find_matches() know them. Throws DataError when the file
  /// cannot be written; as does keep_matches.
  void keep_features(const std::string& picture_digest, FrameFeatures& features) const;
  void keep_matches(const FrameFeatures& first, const FrameFeatures& second, const FeatureMatches& matches) const;

  /// What to tell people of files that were found and could not be used; "" where there was none.
  std::string warning() const;

 private:
  std::optional<std::string> find(const std::filesystem::path& file, const std::string& what);

  std::filesystem::path folder_;
  std::atomic<int> unusable_ = 0;
};

/// To be raised with every change of what is found in pictures (frame_features.cc, frame_pairs.cc), or of the files.
inline constexpr int kMatchRevision = 1;

}  // namespace pilotage
