#pragma once

#include <optional>

#include "pilotage/match/frame_on_grid.h"
#include "pilotage/match/guided_matching.h"
#include "pilotage/match/landmark_matching.h"
#include "pilotage/match/place_ranking.h"
#include "pilotage/match/pose_refinement.h"

namespace pilotage {

/// The refined pose at a place, as a fix.
struct RefinedFix {
  Fix fix;
  PoseCorrection pose;
  std::size_t landmark_groups = 0;  ///< independent_groups() that agree with the pose.
};

/// Refines the pose from the supporters of `place`. Where chips decide, of these as many as chance gives fit any pose,
/// and the others are believed the less. Heights of the map's ground count against that straight below the aircraft
/// there (Relief::ground), as the height of `prior` does. Nothing when the pose does not converge. Without the map's
/// own error: add_map_error().
std::optional<RefinedFix> refine_fix(const FrameOnGrid& rectified, const PivotedFrame& frame, const LocalMap& map,
                                     const MatchPrior& prior, const MatchOptions& options, const RankedPlace& place);

/// The same from the landmarks of `place`: each as far off as was measured on another date, no less than of a frame's
/// pixels can be told, and all together by what objects lean away from the nadir.
std::optional<RefinedFix> refine_fix_by_landmarks(const FrameOnGrid& rectified, const PivotedFrame& frame,
                                                  const LocalMap& map, const MatchPrior& prior,
                                                  const MatchOptions& options, const LandmarkSearch& landmarks,
                                                  const RankedPlace& place);

/// refine_fix(), and how many of the landmarks of `place` agree with it.
std::optional<RefinedFix> refine_fix_beside_landmarks(const FrameOnGrid& rectified, const PivotedFrame& frame,
                                                      const LocalMap& map, const MatchPrior& prior,
                                                      const MatchOptions& options, const LandmarkSearch& landmarks,
                                                      const RankedPlace& place);

/// Adds the error of the map's own georeference, each axis, to both covariances.
void add_map_error(Fix& fix, double map_sigma_m);

/// Whether the height of a fix is more than four standard deviations off the one that was told.
bool contradicts_told_height(const Fix& fix, const MatchOptions& options);

/// Whether a fix contradicts what was known: its position lies outside the searched square or √2 times the prior's
/// error ellipse of search_sigmas (Mahalanobis distance, in a covariance that has 2 / search_sigmas times what the
/// tilt's error moves the place by added), or attitude or height are more than four standard deviations off. The yaw
/// does not count where it is unknown.
bool is_outside_gate(const Fix& fix, const MatchPrior& prior, const MatchOptions& options);

}  // namespace pilotage
