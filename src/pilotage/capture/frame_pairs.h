#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/progress.h"
#include "pilotage/capture/frame_features.h"

namespace pilotage {

class MatchFolder;

/// Features of a frame and of another one that show the same place.
using FeatureMatches = std::vector<std::array<int, 2>>;

/// Two frames that show the same ground, and the features they have in common.
struct FramePair {
  int first = 0;
  int second = 0;
  FeatureMatches matches;
};

/// Pairs of frames that may show the same ground: of each frame with the two that are nearest in each eighth of the
/// circle around it (so that frames close to each other along a line do not hide the next line), and with the one
/// before it in the list. In order of their numbers, the smaller first, each once.
std::vector<std::array<int, 2>> neighbouring_frames(const std::vector<Eigen::Vector2d>& nadirs_en_m);

/// What two frames have in common: the coarsest features first (ratio test, mutual), a homography through them
/// (MAGSAC++), then all features near where it leads, and those that obey one epipolar geometry. Nothing unless 20 do.
/// Deterministic.
FeatureMatches match_frames(const FrameFeatures& first, const FrameFeatures& second);

/// match_frames() for all `pairs`, in their order, without those that have nothing in common. What `folder` has is
/// taken from there, and what it has not is kept there (the features must be from there, too); null: nothing is kept.
/// Throws DataError when the folder cannot be written to; Interrupted.
std::vector<FramePair> match_pairs(const std::vector<std::array<int, 2>>& pairs,
                                   const std::vector<FramePicture>& pictures, MatchFolder* folder, int threads,
                                   const Progress& progress);

}  // namespace pilotage
