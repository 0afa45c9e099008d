#pragma once

#include <vector>

#include "pilotage/capture/frame_pairs.h"

namespace pilotage {

/// Where a frame sees a point.
struct Sighting {
  int frame = 0;
  int feature = 0;
};

/// A point of the ground in all frames that see it, in the order of the frames.
using Track = std::vector<Sighting>;

/// Joins matches that share features (union-find) into tracks. Those that would have a frame see their point at two
/// places are dropped. Of the rest so many stay that each frame has some `per_cell` in each of 8 × 8 parts of its
/// picture, long ones first.
std::vector<Track> join_tracks(const std::vector<FramePair>& pairs, const std::vector<FrameFeatures>& features,
                               int per_cell);

/// The frames, by their numbers, that pairs tie to each other: one list for each part that falls apart, the largest
/// first, each in ascending order.
std::vector<std::vector<int>> tied_parts(const std::vector<FramePair>& pairs, int frames);

}  // namespace pilotage
