#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pilotage/match/chip_mosaic.h"
#include "pilotage/match/chip_search.h"
#include "pilotage/match/direction_search.h"
#include "pilotage/match/frame_on_grid.h"
#include "pilotage/match/guided_matching.h"
#include "pilotage/match/landmark_matching.h"

namespace pilotage {

/// The frame on the map's chips.
struct ChipComparison {
  RectifiedFrame frame;  ///< On level ground.
  ChipMosaic mosaic;
  ChipMatch best;
  std::optional<DirectionSurface> directions;
  Eigen::Vector2d pivot_from_nadir_px{0, 0};  ///< In pixels of the level.
  Eigen::Vector2d reference_px{0, 0};         ///< LocalMap::reference_px.
  /// Evidence of features that would do for a fix without chips: the caller's.
  double enough_evidence = 0;

  /// A place of the nadir as a placement of the pivot, and back.
  Placement placement(const ChipMatch& match) const { return placement(match.nadir_px, match.yaw_deg, match.scale); }
  Placement placement(const DirectionPlace& place) const { return placement(place.nadir_px, place.turn_deg, 1); }
  ChipMatch match_at(const Placement& placement) const {
    ChipMatch match = best;
    match.found = true;
    match.yaw_deg = placement.yaw_rad / kRadPerDeg;
    match.scale = placement.scale;
    match.nadir_px = reference_px + placement.map_from_frame(-pivot_from_nadir_px);
    return match;
  }
  /// Of directions, which were compared: at the nadir that the turn that is nearest to a placement's gives it, as the
  /// frame was not scaled. 0 where they were not.
  double agreement_at(const Placement& placement) const;

 private:
  Placement placement(const Eigen::Vector2d& nadir_px, double yaw_deg, double scale) const {
    Placement turned{{0, 0}, yaw_deg * kRadPerDeg, scale};
    turned.center_px = nadir_px - reference_px + turned.map_from_frame(pivot_from_nadir_px);
    return turned;
  }
};

/// Searches the frame on the chips of the window. Nothing when they are not wanted or the map has none here.
/// Throws DataError when the map is damaged.
std::optional<ChipComparison> compare_chips(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                            MapReader& map, const MatchOptions& options, const FrameOnGrid& rectified,
                                            const PivotedFrame& described, const LocalMap& local,
                                            const Checkpoint& checkpoint = {});

/// Bytes that compare_chips takes at most at a time; 0 when it has nothing to do; infinite when the chips of the window
/// are more than kMaxMosaicSidePx along a side. Throws as compare_chips.
double chip_comparison_bytes(MapReader& map, const MatchOptions& options, const FrameOnGrid& rectified,
                             const PivotedFrame& described);

/// A place and what speaks for it.
struct RankedPlace {
  GuidedMatch match;
  double ncc = 0;
  int compared_px = 0;   ///< Pixels of chips behind it.
  double agreement = 0;  ///< Of the directions of edges.
  LandmarkView landmarks;
  bool by_landmarks = false;  ///< Landmarks alone say more for it than features and chips.
  double of_features = 0;     ///< Evidence of features and chips.
  bool chips_decide = false;  ///< Features alone say too little, ChipComparison::enough_evidence.
  double chance_support = 0;  ///< chance_support() there.
  double evidence = 0;        ///< Of all.
};

/// Whether another place nearer to the best than kMinRivalDistance_m is a rival all the same: chips decide for the
/// best, and it is nearly as good. Edges that lie in a line agree along it.
bool is_near_rival(const RankedPlace& best, const RankedPlace& place);

/// The best place, and the evidence of the best elsewhere: kMinRivalDistance_m away.
struct RankedPlaces {
  RankedPlace best;
  std::optional<RankedPlace> next_there;  ///< The next best that is no rival: the best place as something else has it.
  /// The best beside it that is not the same one, kSamePlacePx away in pixels of the chips. Only with chips.
  std::optional<RankedPlace> nearby;
  double rival_evidence = 0;
  double rival_ncc = 0;
};

/// Whether frame or map have fewer than kMinFeatures: then landmarks alone may speak for a place.
bool has_few_features(const PivotedFrame& frame, const LocalMap& map);

/// Candidates by votes, each looked at again where its features should be; the kRankedPlaces best of them, those that
/// chips and landmarks have as their own best are held against the chips and the landmarks and ranked by their
/// evidence: place_evidence(), or evidence_of_landmarks() and what features that lie on none of these landmarks say,
/// whichever is more. Nothing when nothing has votes.
std::optional<RankedPlaces> rank_places(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                        const std::optional<ChipComparison>& chips,
                                        const std::optional<LandmarkSearch>& landmarks, double gsd_m,
                                        const Checkpoint& checkpoint = {});

/// Of 400 real frames, 95 % had the true place among the first 30.
inline constexpr std::size_t kCandidates = 30;
inline constexpr std::size_t kRankedPlaces = 8;
/// Of frame and map: what fewer say was never measured, and is no evidence.
inline constexpr std::size_t kMinFeatures = 20;
inline constexpr std::size_t kLandmarkPlaces = 4;
inline constexpr std::size_t kDirectionPlaces = 3;
/// What lies nearer to a place is the same place once more.
inline constexpr double kMinRivalDistance_m = 12;
inline constexpr double kSamePlacePx = 3;

}  // namespace pilotage
