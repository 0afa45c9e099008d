#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/landmark/landmark_model.h"
#include "pilotage/landmark/train_options.h"

namespace pilotage {

/// Labels of a class below which nothing is trained: they would tell one landmark, not a class.
inline constexpr int kLeastLabels = 8;
/// Pixels of the imagery along a landmark below which nothing is trained.
inline constexpr double kLeastLength_px = 10;

struct TrainedLandmarks {
  LandmarkModel model;
  /// Of each detector, labels that no place of its window covers by half: too small beside the others; not learnt.
  std::vector<int> unobtainable;
  std::vector<std::string> warnings;
};

/// A detector for each class of the chips that `pilotage landmark-label` wrote into `folders`; chips of several dates
/// of one ground are learnt together. Landmarks that are not round are turned to each heading that has a filter. What
/// is taken for a landmark on background is learnt as background in a second round. Quality is that of ground left out:
/// blocks are strips across the longer side of the ground with as many labels each, and chips that share ground with a
/// block are left out with it. Deterministic for any number of threads. Throws UsageError; DataError as
/// read_training_chips(), for a class with fewer than kLeastLabels landmarks of kLeastLength_px and more, and
/// for a detector that finds none of the labels that it learnt; Interrupted.
TrainedLandmarks train_landmarks(const std::vector<std::string>& folders, const TrainOptions& options, int threads,
                                 std::uint64_t seed, const Progress& progress = {});

}  // namespace pilotage
