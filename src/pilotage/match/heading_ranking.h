#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/camera/camera.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/match/checkpoint.h"
#include "pilotage/match/frame_on_grid.h"
#include "pilotage/match/match.h"

namespace pilotage {

/// The `count` of `headings_deg` that a coarse look at the features says most for, most first; all of them, in that
/// order, where there are no more. Of equal ones the earlier comes first, so they are the first `count` where the look
/// finds nothing: the map has no features here, the frame cannot be rectified, or the window holds more features than
/// options.max_memory_mib has room for.
///
/// The frame is rectified once and turned for each heading, and described at every second to fourth pixel along both
/// axes, so that some kCoarsePoints are left; of the map's features so many vote (displacement_voting.h) that about
/// kCoarseVoters lie under the frame. Their pairs are counted in bins of kCoarseBinPx at one scale and three turns
/// about the heading, and what the highest bin has above the mean, over the root of the mean, ranks the heading: of
/// votes of chance that is their standard deviation (S. D. Poisson, 1837). `options` are those of a search about one of
/// the headings: yaw_sigma_deg is half of how far a neighbour reaches. docs/methods/match.md has how often the right
/// heading is among the first. Throws DataError when the map is damaged.
std::vector<double> promising_headings_deg(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                           MapReader& map, const MatchOptions& options,
                                           const std::vector<double>& headings_deg, std::size_t count,
                                           const Checkpoint& checkpoint = {});

/// A rectified frame whose picture is continued (frame_grid.h) as it is with another heading, `turn_rad` clockwise of
/// its own: turned about the nadir, on the same grid.
FrameOnGrid turned_frame(const FrameOnGrid& rectified, double turn_rad);

inline constexpr double kCoarsePoints = 4000;
inline constexpr int kFinestCoarseStepPx = 2;
inline constexpr int kCoarsestStepPx = 4;
inline constexpr double kCoarseBinPx = 8;
inline constexpr double kCoarseVoters = 400;

}  // namespace pilotage
