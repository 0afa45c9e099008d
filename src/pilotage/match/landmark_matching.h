#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/camera.h"
#include "pilotage/match/checkpoint.h"
#include "pilotage/match/frame_on_grid.h"

namespace pilotage {

/// What a detector of the map found on a frame.
struct LandmarkSighting {
  std::size_t detector = 0;
  Eigen::Vector2d from_pivot_px{0, 0};  ///< On level ground, as PivotedFrame has its points.
};

/// A landmark of the map that the frame may show.
struct NearLandmark {
  std::size_t detector = 0;
  Eigen::Vector2d map_px{0, 0};  ///< As LocalMap has its features.
  double height_m = 0;           ///< Of its ground; NaN where unknown.
  double stretch = 1;            ///< Relief::stretch of its ground.
};

/// Sightings of a frame, and the landmarks within the window.
struct LandmarkSearch {
  std::vector<LandmarkSighting> sightings;
  std::vector<NearLandmark> near;
  std::vector<double> sigma_m;           ///< By detector: of sightings, each axis.
  std::vector<double> tolerance_px;      ///< By detector: how far a sighting may lie from its landmark.
  std::vector<double> landmarks_in_px2;  ///< By detector: how dense its landmarks are in the window.
  double turns_and_scales = 1;           ///< How many of them, at most, a frame can be laid on landmarks with.
};

/// A sighting that lies on a landmark.
struct LandmarkPair {
  std::size_t sighting = 0;
  std::size_t near = 0;
};

/// Lays the frame north up at the pixels of each detector that has landmarks in the window, and looks for them. Nothing
/// when they are not wanted, the map has none here, or none is seen. Throws DataError when the map is damaged.
std::optional<LandmarkSearch> look_for_landmarks(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                                 MapReader& map, const MatchOptions& options,
                                                 const FrameOnGrid& rectified, const PivotedFrame& described,
                                                 const LocalMap& local, const SearchSpace& space,
                                                 const Checkpoint& checkpoint = {});

/// Bytes that look_for_landmarks takes at most at a time; 0 when it has nothing to do.
double landmark_search_bytes(const MapReader& map, const MatchOptions& options);

/// Sightings and the landmarks of their class on which a placement puts them, nearest first, each once.
std::vector<LandmarkPair> pair_landmarks(const PivotedFrame& frame, const LandmarkSearch& search,
                                         const Placement& placement);

/// Displacement voting: each sighting on each landmark of its class puts the frame somewhere; the places of the square
/// where two sightings at least agree, up to what the prior's turn and scale leave open, are fitted to all that agree.
/// At most `count`, most sightings first; of equals that of the first pair. Only so many sightings vote as are compared
/// within some 0.3 s.
std::vector<Placement> landmark_places(const PivotedFrame& frame, const LandmarkSearch& search,
                                       const SearchSpace& space, std::size_t count, const Checkpoint& checkpoint = {});

/// How many turns and scales there are in which sightings lie on other landmarks, at most: LandmarkSearch's own number.
double turns_and_scales(const LandmarkSearch& search, const SearchSpace& space);

/// −ln of the chance that so many of the sightings lie on landmarks at a place that has nothing to do with them: a
/// Poisson count whose mean is the sum over sightings of the landmarks of their class within their tolerance. 0 of
/// none.
double coincidence(const LandmarkSearch& search, std::size_t pairs);

/// What so many sightings on landmarks say for a place alone, as place_evidence(): −ln of the rate at which the best
/// place of a window of kCalibratedHalfWidthPx has them by chance. Each pair puts the frame somewhere; that another
/// agrees with it, within twice the tolerance, has the chance of coincidence(); so many agree in some turn and scale at
/// most as often as all of these together (the expected number bounds the probability, as in scan statistics: J. I.
/// Naus, "Approximations for distributions of scan statistics", JASA 77, 1982). At least 0.
double landmark_evidence(const LandmarkSearch& search, std::size_t pairs);

/// Both: where features speak for a place, the rate at which the best place of other ground looks as good times the
/// chance that all but one of the sightings lie on landmarks: features of one landmark on another of its class speak
/// for that place, too. Else landmarks alone.
double joint_evidence(double of_features, const LandmarkSearch& search, std::size_t pairs);

/// Landmarks alone make no place of fewer.
inline constexpr std::size_t kLeastLandmarks = 2;

}  // namespace pilotage
