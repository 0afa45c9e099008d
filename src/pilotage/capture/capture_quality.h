#pragma once

#include <vector>

#include "pilotage/capture/capture.h"
#include "pilotage/verdict/quality.h"

namespace pilotage {

/// What a captured map is judged by. Conventions of the trade where they exist (shares of frames as Pix4D's quality
/// report has them), and else limits below which something is usually wrong; docs/commands/capture.md.
struct CaptureThresholds {
  static constexpr double kFramesGood = 0.95;  ///< Share of the frames given that are in the map.
  static constexpr double kFramesMarginal = 0.6;
  static constexpr double kSightingsGood = 100;  ///< Of the frame in the middle.
  static constexpr double kSightingsMarginal = 40;
  static constexpr double kFittingGood = 0.9;  ///< Share of the sightings found that fit together.
  static constexpr double kFittingMarginal = 0.7;
  static constexpr double kReprojectionGood_px = 1;
  static constexpr double kReprojectionMarginal_px = 2;
  static constexpr double kFocalChangeGood = 0.03;
  static constexpr double kFocalChangeMarginal = 0.1;
  static constexpr double kPositionRatioGood = 1.5;  ///< Of residuals to what is stated of positions.
  static constexpr double kPositionRatioMarginal = 3;
  static constexpr double kSeenByThreeGood = 0.8;  ///< Share of the map.
  static constexpr double kSeenByThreeMarginal = 0.5;
  static constexpr double kReliefGood_m = 1;  ///< That the surface leaves out.
  static constexpr double kReliefMarginal_m = 5;
  static constexpr double kCheckRatioGood = 2;  ///< Of misses to what the map says of itself.
  static constexpr double kCheckRatioMarginal = 3;
  static constexpr double kControlRatioGood = 2;  ///< Of misses to what is stated and a pixel of the map together.
  static constexpr double kControlRatioMarginal = 3;
  static constexpr int kControlPointsGood = 4;
  static constexpr int kTiesGood = 4;
  static constexpr double kReferenceGood_m = 3;  ///< Standard deviation of another map, each axis.
};

/// The rows of the page: how a block hangs together, and what its place on the ground rests on. None of them decides:
/// the map says its own error, and a mission has its own limit.
std::vector<QualityRow> capture_quality(const CaptureResult& done);

}  // namespace pilotage
