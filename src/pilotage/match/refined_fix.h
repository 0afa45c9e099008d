#pragma once

#include <optional>

#include "pilotage/match/frame_on_grid.h"
#include "pilotage/match/guided_matching.h"
#include "pilotage/match/pose_refinement.h"

namespace pilotage {

/// The refined pose at a place, as a fix.
struct RefinedFix {
  Fix fix;
  PoseCorrection pose;
};

/// Refines the pose from the supporters of `place`. Heights of the map's ground count against their mean. Nothing when
/// the pose does not converge.
std::optional<RefinedFix> refine_fix(const FrameOnGrid& rectified, const PivotedFrame& frame, const LocalMap& map,
                                     const MatchPrior& prior, const MatchOptions& options, const GuidedMatch& place);

/// Whether a pose lies outside the searched square, or more than four standard deviations from the prior attitude or
/// height.
bool is_outside_gate(const FrameOnGrid& rectified, const LocalMap& map, const MatchPrior& prior,
                     const MatchOptions& options, const PoseCorrection& pose);

}  // namespace pilotage
