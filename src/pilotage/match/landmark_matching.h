#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/camera.h"
#include "pilotage/mapdb/map_landmarks.h"
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
  double length_m = 0;
  double half_side_px = 0;  ///< Of the square about it that its detector looks at.
  bool found = true;        ///< On the other date: then it should be seen.
  std::size_t group = 0;    ///< group_landmarks().
};

/// Sightings of a frame, and the landmarks within the window.
struct LandmarkSearch {
  std::vector<LandmarkSighting> sightings;
  std::vector<NearLandmark> near;
  std::vector<double> sigma_m;           ///< By detector: of sightings, each axis.
  std::vector<double> tolerance_px;      ///< By detector: how far a sighting may lie from its landmark.
  std::vector<double> landmarks_in_px2;  ///< By detector: landmark_densities().
  std::vector<double> p_detect;          ///< By detector: of a landmark that the frame shows, at least; 0 when it found
                                         ///< more than are kept, and what is missing is not known.
  std::vector<Eigen::AlignedBox2d> looked_at_px;  ///< By detector: what it saw of the frame, from the pivot.
  double turns_and_scales = 1;                    ///< How many of them, at most, a frame can be laid on landmarks with.
};

/// A sighting that lies on a landmark.
struct LandmarkPair {
  std::size_t sighting = 0;
  std::size_t near = 0;
};

/// How far a sighting may lie from its landmark: three σ of it and of the place.
double landmark_tolerance_m(const MapDetector& detector, double gsd_m);

/// Half the side of the square about a landmark of this length that the detector looks at.
double looked_at_half_side_m(const MapDetector& detector, double length_m);

/// P that a landmark of this class, found on the other date, is seen on a frame that shows it whole, at least.
double p_seen_on_frame(const MapDetector& detector);

/// Numbers landmarks, of whatever class, so that those of one number hang together in steps of at most `link_px`. What
/// stands together, two classes on one object, tanks of a farm, is built alike elsewhere: a group says once that a
/// place is right, however many of its landmarks agree.
void group_landmarks(double link_px, std::vector<NearLandmark>& landmarks, const Checkpoint& checkpoint = {});

/// Which landmarks stand in a crowd: hang together with others of their class over more than three such steps, as roofs
/// of a town do. There is always one under a sighting; they say nothing of a place, and what stands among them should
/// not be taken for one of them.
std::vector<bool> in_crowds(double link_px, const std::vector<NearLandmark>& landmarks,
                            const Checkpoint& checkpoint = {});

/// How dense landmarks of each detector are: in the circle of `reach_px`, or about each other within `radius_px` of a
/// frame, whichever is more: a place that has one under a sighting is where landmarks are. One more is counted than
/// there are: of few, chance may have put some more elsewhere.
std::vector<double> landmark_densities(const std::vector<NearLandmark>& landmarks, std::size_t detectors,
                                       double reach_px, double radius_px, const Checkpoint& checkpoint = {});

/// How far from a window's middle a frame at any of its places may show something, in the unit of both.
double landmark_reach(double half_width, double frame_radius);

/// Landmarks of the map in the circle of `reach_px` about `center_px`; none where they are not wanted, or are more than
/// kMaxNearLandmarks. Places are pixels of the grid from `reference_px`, the centre's, too; each stretch is 1, each
/// group 0. Throws DataError when the map is damaged.
std::vector<NearLandmark> landmarks_near(MapReader& map, const MatchOptions& options, const LocalGrid& grid,
                                         const Eigen::Vector2d& reference_px, const Eigen::Vector2d& center_px,
                                         double reach_px, const Checkpoint& checkpoint = {});

/// Whether the map has a landmark, of those wanted, that is no farther from `point`.
bool has_landmark_within(MapReader& map, const MatchOptions& options, GeodeticPoint point, double radius_m,
                         const Checkpoint& checkpoint = {});

/// Lays the frame north up at the pixels of each detector that has landmarks in the window, and looks for them. Nothing
/// when there are none `near`, or none is seen. Throws DataError when the map is damaged.
std::optional<LandmarkSearch> look_for_landmarks(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                                 MapReader& map, const FrameOnGrid& rectified,
                                                 const PivotedFrame& described, const LocalMap& local,
                                                 const SearchSpace& space, std::vector<NearLandmark> near,
                                                 const Checkpoint& checkpoint = {});

/// Bytes that look_for_landmarks takes at most at a time; 0 when it has nothing to do.
double landmark_search_bytes(const MapReader& map, const MatchOptions& options);

/// Sightings and the landmarks of their class on which a placement puts them, nearest first, each once.
std::vector<LandmarkPair> pair_landmarks(const PivotedFrame& frame, const LandmarkSearch& search,
                                         const Placement& placement, const Checkpoint& checkpoint = {});

/// What landmarks say of a place.
struct LandmarkView {
  std::vector<LandmarkPair> pairs;
  std::size_t groups = 0;    ///< independent_groups() of the pairs.
  std::size_t expected = 0;  ///< Pairs, and landmarks that the frame should show there, all of what their detector
                             ///< looks at, and that were not seen.
  double against = 0;  ///< −ln of the chance that so many groups, or more, are not seen where the place is right.
};

/// pair_landmarks(), and what is missing. Where the frame was not described it is taken to show nothing.
LandmarkView view_landmarks(const PivotedFrame& frame, const LandmarkSearch& search, const Placement& placement,
                            const Checkpoint& checkpoint = {});

/// How many of the landmarks of pairs say something of their own: one of each group; of those that lie along a line,
/// within the tolerance, two; and none at a difference from another that the window's landmarks have more than once. A
/// row or a grid of things lies on another one wherever one of them does.
std::size_t independent_groups(const LandmarkSearch& search, const std::vector<LandmarkPair>& pairs);

/// Displacement voting: each sighting on each landmark of its class puts the frame somewhere; the places of the square
/// where kLeastLandmarks groups at least agree, up to what the prior's turn and scale leave open, are fitted to all
/// that agree. At most `count`, none nearer than `min_distance_px` to a better one, most groups first; of equals that
/// of the first pair. Sightings vote the strongest of each class first, so many as are compared within some 0.3 s.
std::vector<Placement> landmark_places(const PivotedFrame& frame, const LandmarkSearch& search,
                                       const SearchSpace& space, std::size_t count, double min_distance_px,
                                       const Checkpoint& checkpoint = {});

/// How many turns and scales there are in which sightings lie on other landmarks, at most: LandmarkSearch's own number.
double turns_and_scales(const LandmarkSearch& search, const SearchSpace& space);

/// What so many groups, sightings on landmarks of each, say for a place alone, as place_evidence(): −ln of the rate at
/// which the best place of a window of kCalibratedHalfWidthPx has them by chance. Each pair puts the frame somewhere;
/// the sightings that lie on landmarks within twice the tolerance there are a Poisson count, groups being independent
/// of each other; so many agree in some turn and scale at most as often as all of these together (the expected number
/// bounds the probability, as in scan statistics: J. I. Naus, "Approximations for distributions of scan statistics",
/// JASA 77, 1982). 0 of fewer than kLeastLandmarks.
double landmark_evidence(const LandmarkSearch& search, std::size_t groups);

/// What landmarks say alone, less what is against the place: landmarks that are not seen, and `chips_against`,
/// correlation_evidence() where negative. At least 0.
double evidence_of_landmarks(double chips_against, const LandmarkSearch& search, const LandmarkView& view);

/// Of fewer groups landmarks make no place: two at a like distance are common.
inline constexpr std::size_t kLeastLandmarks = 3;
/// How far off landmarks are taken to be independent of each other.
inline constexpr double kLandmarkGroup_m = 60;
/// More say no more: the evidence of so many is beyond any rate that is asked for.
inline constexpr std::size_t kMostGroups = 16;
/// Side of what is looked at of a frame, about its middle, in pixels of the detector.
inline constexpr int kMaxLookedAtPx = 1536;
/// Of a window: more are no landmarks.
inline constexpr std::size_t kMaxNearLandmarks = 1000;

}  // namespace pilotage
