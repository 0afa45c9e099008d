#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pilotage/camera/camera.h"
#include "pilotage/ground/ground.h"
#include "pilotage/mapdb/map_landmarks.h"

namespace pilotage {

/// What landmarks promise to a frame about the middle of a tile, whatever its heading.
struct LandmarkProspect {
  std::vector<std::size_t> shown;  ///< Indices of MapLandmarks::landmarks, ascending: found on the other date, and some
                                   ///< frame shows them whole.
  double p_fix = 0;                ///< P of a fix by landmarks alone, the mean over eight headings.
};

/// Of each tile of the ground. The frame is the rectangle of the camera's footprint in level flight at the middle of
/// the level's heights (the tile itself for a camera without one); a landmark that was found on the other date is seen
/// with p_seen_on_frame() when all that its detector looks at lies in it, false alarms come as often as on the other
/// date, and the frame's place is known to within `search_radius_m` along each axis, besides what errors of attitude
/// add. P is the chance that the groups that are seen reach the evidence that the defaults of MatchOptions ask for.
/// Modelled; held against frames of made-up countries (docs/methods/landmarks.md). Not modelled: a rival, relief, and
/// that the matcher looks at nothing where the map stores no tile.
std::vector<LandmarkProspect> landmark_prospects(const Ground& ground, const MapLandmarks& landmarks,
                                                 const Camera& camera, double search_radius_m);

/// Pixels of a camera may be so many times as wide as those of a detector: coarser ones were not tried.
inline constexpr double kCoarsestOfDetector = 1.6;

/// Classes that landmark_prospects() does not count on some level, for the camera's pixels are coarser there.
std::vector<std::string> unresolved_classes(const Ground& ground, const MapLandmarks& landmarks, const Camera& camera);

}  // namespace pilotage
