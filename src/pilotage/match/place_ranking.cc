#include "pilotage/match/place_ranking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pilotage/base/angle.h"
#include "pilotage/match/match_confidence.h"

namespace pilotage {
namespace {

constexpr int kChipReachPx = 2;
constexpr int kChipTurns = 3;   // hypotheses
constexpr int kChipScales = 3;  // likewise
/// Windows to each side that are searched on every pixel of the chips: some 150 m. Wider ones from coarse to fine.
constexpr double kFineHalfWidthPx = 128;

bool chips_are_wanted(const MapReader& map, const MatchOptions& options, const FrameOnGrid& rectified) {
  return options.chips && map.has_chips() && rectified.grid.is_of_level;
}

/// Half side of the square of chips that the frame may show, in pixels of the level.
double chip_reach_px(const FrameOnGrid& rectified, const PivotedFrame& described) {
  return rectified.half_width_px + rectified.px_from_m(rectified.pivot_m).norm() + 1.2 * described.radius_px;
}

/// What features say for a place without those on its landmarks: these look right wherever landmarks lie on others of
/// their class. Chips show the landmarks, too, and do not count.
double evidence_beside_landmarks(const RankedPlace& place, const PivotedFrame& described, const LocalMap& map,
                                 const LandmarkSearch& landmarks) {
  if (has_few_features(described, map)) return 0;
  const std::vector<GuidedPair> supporters = supporting_pairs(described, map, place.match.placement);
  if (supporters.empty()) return 0;
  const auto on_landmark = [&](const GuidedPair& supporter) {
    return std::any_of(place.landmarks.pairs.begin(), place.landmarks.pairs.end(), [&](const LandmarkPair& pair) {
      const NearLandmark& landmark = landmarks.near[pair.near];
      return (supporter.map_px - landmark.map_px).cwiseAbs().maxCoeff() <= landmark.half_side_px;
    });
  };
  const auto beside = std::ssize(supporters) - std::count_if(supporters.begin(), supporters.end(), on_landmark);
  const double share = static_cast<double>(beside) / static_cast<double>(supporters.size());
  return place_evidence(
      {share * place.match.evidence(), place.match.expected, descriptor_of(map.features), map.features_per_mpx});
}

RankedPlace rank_place(const GuidedMatch& match, const PivotedFrame& described, const LocalMap& map,
                       const std::optional<ChipComparison>& chips, const std::optional<LandmarkSearch>& landmarks,
                       const Checkpoint& checkpoint) {
  RankedPlace place;
  place.match = match;
  if (chips) {
    const ChipMatch here = chips->match_at(match.placement);
    const RectifiedFrame frame =
        laid_over_relief(chips->frame, map.relief, here.nadir_px - map.reference_px, chips->mosaic.factor);
    const ChipMatch there = confirm_chip_match(frame, chips->mosaic, here, kChipReachPx);
    place.ncc = there.found ? there.ncc : 0;
    place.compared_px = there.found ? there.pixels : 0;
    if (chips->directions) place.agreement = chips->agreement_at(match.placement);
  }
  const PlaceEvidence seen{match.evidence(),
                           match.expected,
                           descriptor_of(map.features),
                           map.features_per_mpx,
                           place.ncc,
                           static_cast<double>(place.compared_px),
                           place.agreement,
                           chips && chips->directions ? chips->directions->reach() : 0};
  place.evidence = place_evidence(seen);
  place.chips_decide = chips && support_evidence(seen) < chips->enough_evidence;
  place.chance_support = chance_support(seen);
  if (has_few_features(described, map)) place.evidence = 0;
  place.of_features = place.evidence;
  if (!landmarks) return place;
  place.landmarks = view_landmarks(described, *landmarks, match.placement, checkpoint);
  const double chips_against = std::max(0.0, -chip_evidence(seen));
  const double alone = evidence_of_landmarks(chips_against, *landmarks, place.landmarks);
  if (alone <= 0) return place;
  place.by_landmarks = alone > place.of_features;
  place.evidence = std::max(place.of_features, alone + evidence_beside_landmarks(place, described, map, *landmarks));
  return place;
}

}  // namespace

double ChipComparison::agreement_at(const Placement& placement) const {
  if (!directions || directions->turns_deg.empty()) return 0;
  const double yaw_deg = placement.yaw_rad / kRadPerDeg;
  const double turn_deg =
      *std::min_element(directions->turns_deg.begin(), directions->turns_deg.end(),
                        [&](double a, double b) { return std::abs(a - yaw_deg) < std::abs(b - yaw_deg); });
  Placement as_compared = placement;
  as_compared.yaw_rad = turn_deg * kRadPerDeg;
  as_compared.scale = 1;
  return directions->at(reference_px + as_compared.map_from_frame(-pivot_from_nadir_px));
}

bool is_near_rival(const RankedPlace& best, const RankedPlace& place) {
  const double distance_px = (place.match.placement.center_px - best.match.placement.center_px).norm();
  return best.chips_decide && best.evidence <= best.of_features && distance_px > kSamePlacePx &&
         best.evidence - place.evidence < least_lead(0, 0);
}

std::optional<ChipComparison> compare_chips(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                            MapReader& map, const MatchOptions& options, const FrameOnGrid& rectified,
                                            const PivotedFrame& described, const LocalMap& local,
                                            const Checkpoint& checkpoint) {
  if (!chips_are_wanted(map, options, rectified)) return std::nullopt;
  ChipComparison chips;
  chips.reference_px = local.reference_px;
  chips.pivot_from_nadir_px = rectified.px_from_m(rectified.pivot_m);
  chips.mosaic = read_chip_mosaic(map, rectified.level->matrix.level, rectified.prior_px,
                                  chip_reach_px(rectified, described), checkpoint);
  if (chips.mosaic.gray.empty()) return std::nullopt;
  RectifyOptions rectify;
  rectify.gsd_m = rectified.gsd_m * chips.mosaic.factor;
  rectify.max_size_px = kMaxRectifiedSidePx;
  chips.frame =
      ortho_rectify(frame, camera, attitude_on_grid(prior.attitude, rectified.grid), prior.height_agl_m, rectify);
  if (chips.frame.status != RectifyStatus::kOk) return std::nullopt;
  // Over the whole window as the ground is where the aircraft should be: places found so are looked at again on theirs.
  const RectifiedFrame searched =
      laid_over_relief(chips.frame, local.relief, rectified.prior_px - local.reference_px, chips.mosaic.factor);
  const auto hypotheses =
      chip_hypotheses(1.5 * options.yaw_sigma_deg, kChipTurns, 1.5 * options.height_sigma_fraction, kChipScales);
  if (rectified.half_width_px / chips.mosaic.factor <= kFineHalfWidthPx) {
    chips.best =
        search_chips(searched, chips.mosaic, rectified.prior_px, rectified.half_width_px, hypotheses, {}, checkpoint);
  } else {
    const auto coarse = chip_hypotheses(0.75 * options.yaw_sigma_deg, kChipTurns - 1,
                                        0.75 * options.height_sigma_fraction, kChipScales - 1);
    chips.best = search_chips_coarsely(searched, chips.mosaic, rectified.prior_px, rectified.half_width_px, coarse,
                                       hypotheses, {}, checkpoint);
  }
  const double turn_deg = 1.5 * options.yaw_sigma_deg;
  chips.directions = search_directions(searched, chips.mosaic, rectified.prior_px, rectified.half_width_px,
                                       {-turn_deg, 0, turn_deg}, checkpoint);
  return chips;
}

double chip_comparison_bytes(MapReader& map, const MatchOptions& options, const FrameOnGrid& rectified,
                             const PivotedFrame& described) {
  if (!chips_are_wanted(map, options, rectified)) return 0;
  const double reach_px = chip_reach_px(rectified, described);
  const int factor = chip_factor(map, rectified.level->matrix.level, rectified.prior_px, reach_px);
  if (factor == 0) return 0;
  const double mosaic_side_px = 2 * reach_px / factor + 2;
  if (mosaic_side_px > kMaxMosaicSidePx) return std::numeric_limits<double>::infinity();
  const cv::Size frame = rectified.frame.gray.size();
  return 2 * mosaic_side_px * mosaic_side_px + 2 * relief_frame_bytes(std::max(frame.width, frame.height)) +
         chip_search_bytes(std::max(frame.width, frame.height), rectified.half_width_px / factor,
                           static_cast<std::size_t>(kChipTurns) * kChipScales) +
         direction_search_bytes(std::max(frame.width, frame.height), rectified.half_width_px / factor);
}

bool has_few_features(const PivotedFrame& frame, const LocalMap& map) {
  return frame.grid.points.size() < kMinFeatures || map.features.size() < kMinFeatures;
}

std::optional<RankedPlaces> rank_places(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                        const std::optional<ChipComparison>& chips,
                                        const std::optional<LandmarkSearch>& landmarks, double gsd_m,
                                        const Checkpoint& checkpoint) {
  std::vector<GuidedMatch> matches =
      match_guided(frame, map, space, vote_for_displacements(frame, map, space, kCandidates, checkpoint), checkpoint);
  std::stable_sort(matches.begin(), matches.end(),
                   [](const GuidedMatch& a, const GuidedMatch& b) { return a.evidence() > b.evidence(); });
  if (matches.size() > kRankedPlaces) matches.resize(kRankedPlaces);
  const double min_distance_px = std::max(kMinRivalDistance_m / gsd_m, kPeakSeparationPx);
  std::vector<Candidate> without_votes;
  if (chips && chips->best.found) without_votes.push_back({chips->placement(chips->best), 0});
  if (chips && chips->directions) {
    for (const DirectionPlace& place : direction_places(*chips->directions, kDirectionPlaces, min_distance_px)) {
      without_votes.push_back({chips->placement(place), 0});
    }
  }
  std::vector<GuidedMatch> by_landmarks;
  if (landmarks) {
    for (const Placement& place :
         landmark_places(frame, *landmarks, space, kLandmarkPlaces, min_distance_px, checkpoint)) {
      without_votes.push_back({place, 0});
      // As the landmarks have it, too: few features may draw a place away from them.
      by_landmarks.emplace_back().placement = place;
    }
  }
  for (const auto& more : {match_guided(frame, map, space, without_votes, checkpoint), by_landmarks}) {
    matches.insert(matches.end(), more.begin(), more.end());
  }
  if (matches.empty()) return std::nullopt;
  std::vector<RankedPlace> ranked;
  for (const GuidedMatch& match : matches) {
    pass(checkpoint);
    ranked.push_back(rank_place(match, frame, map, chips, landmarks, checkpoint));
  }
  RankedPlaces places;
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const RankedPlace& a, const RankedPlace& b) { return a.evidence > b.evidence; });
  places.best = ranked.front();
  for (const RankedPlace& place : ranked) {
    const double distance_px = (place.match.placement.center_px - places.best.match.placement.center_px).norm();
    if (distance_px <= min_distance_px) {
      if (&place != &ranked.front() && !places.next_there) places.next_there = place;
      const bool is_other = chips && distance_px > kSamePlacePx * chips->mosaic.factor;
      if (is_other && !places.nearby) places.nearby = place;
      continue;
    }
    places.rival_evidence = std::max(places.rival_evidence, place.evidence);
    places.rival_ncc = std::max(places.rival_ncc, place.ncc);
  }
  return places;
}

}  // namespace pilotage
