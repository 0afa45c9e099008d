#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/base/shard.h"
#include "pilotage/capture/capture_options.h"

namespace pilotage {

/// What was matched of a part of the pairs.
struct MatchedShard {
  std::int64_t pairs = 0;             ///< Of the shard, without those of pictures that could not be read; of
  std::int64_t pairs_in = 0;          ///< all.
  std::int64_t in_common = 0;         ///< That show ground in common.
  std::int64_t frames = 0;            ///< Whose pictures were read for them.
  std::vector<std::string> left_out;  ///< "path: why".
  std::vector<std::string> warnings;
};

/// Finds features and matches pairs of frames for one of several machines, into the folder CaptureOptions::matches,
/// from which capture() takes them. The shards cut the pairs of neighbouring_frames() of all frames; where pictures
/// cannot be read, the pairs that capture() then has instead of theirs are left to it. Pictures that several shards
/// need are worked on by each that does not find them done. Throws UsageError where the folder is not given, and as
/// shard_ranks; and as capture() does of options, frames, pictures and the folder.
MatchedShard match_shard(const std::vector<std::string>& inputs, const CaptureOptions& options, const Shard& shard,
                         int threads, const Progress& progress = {});

}  // namespace pilotage
