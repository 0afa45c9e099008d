#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/base/shard.h"
#include "pilotage/capture/capture_options.h"

namespace pilotage {

/// What was matched of a part of the frames.
struct MatchedShard {
  std::int64_t frames = 0;            ///< Whose pairs these are, of
  std::int64_t frames_in = 0;         ///< all.
  std::int64_t pairs = 0;             ///< Of a frame of the shard with a later one.
  std::int64_t in_common = 0;         ///< That show ground in common.
  std::vector<std::string> left_out;  ///< "path: why".
  std::vector<std::string> warnings;
};

/// Finds features and matches pairs as capture() does, for one of several machines, into the folder
/// CaptureOptions::matches, from which capture() takes them. Each of the frames is of one shard, with its pairs with
/// later frames; pictures that several shards need are read by each that does not find them there. Throws UsageError
/// where that folder is not given, and as shard_ranks; and as capture() does of frames and pictures.
MatchedShard match_shard(const std::vector<std::string>& inputs, const CaptureOptions& options, const Shard& shard,
                         const std::string& software_version, int threads, const Progress& progress = {});

}  // namespace pilotage
