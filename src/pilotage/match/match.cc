#include "pilotage/match/match.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/match/frame_on_grid.h"
#include "pilotage/match/heading_ranking.h"
#include "pilotage/match/landmark_matching.h"
#include "pilotage/match/local_map.h"
#include "pilotage/match/match_confidence.h"
#include "pilotage/match/place_ranking.h"
#include "pilotage/match/position_measurement.h"
#include "pilotage/match/refined_fix.h"
#include "pilotage/match/relief.h"
#include "pilotage/match/search_memory.h"

namespace pilotage {
namespace {

constexpr double kMaxSearchBins = 1e9;
constexpr double kMaxComparisons = 2e10;
constexpr double kHeadingStepDeg = 10;
/// Up to this σ of yaw one search is enough: turns of two σ are within what upright descriptors tolerate. Above it
/// headings are swept.
constexpr double kKnownYawSigmaDeg = 3;
constexpr double kFoundYawSigmaDeg = 1.5;  // of a heading that a sweep has found
constexpr std::size_t kHeadingsLookedAtAgain = 3;
constexpr std::size_t kMostHeadingsSearched = 12;  // of those swept

bool is_inside(double value, double low, double high) {
  return value >= low && value <= high;
}

bool options_are_good(const MatchOptions& options) {
  // check_options() throws; matching does not.
  try {
    check_options(options);
  } catch (const UsageError&) {
    return false;
  }
  return true;
}

bool covariance_is_good(const Eigen::Matrix2d& covariance) {
  // What is not symmetric to rounding is no covariance.
  return std::abs(covariance(0, 1) - covariance(1, 0)) <= 1e-9 * covariance.norm() &&
         is_inside(smallest_sigma_m(covariance), 1e-3, 1e5) && is_inside(largest_sigma_m(covariance), 1e-3, 1e5);
}

bool prior_is_good(const MatchPrior& prior) {
  return std::isfinite(prior.position.lon_deg) && is_inside(prior.position.lon_deg, -360, 360) &&
         is_inside(prior.position.lat_deg, -90, 90) && covariance_is_good(prior.covariance_en_m2) &&
         is_inside(prior.height_agl_m, 1e-3, 1e5) && std::isfinite(prior.attitude.yaw_deg) &&
         std::isfinite(prior.attitude.pitch_deg) && std::isfinite(prior.attitude.roll_deg);
}

MatchResult refused(MatchStatus status, const MatchStats& stats) {
  MatchResult result;
  result.status = status;
  result.stats = stats;
  return result;
}

/// Another answer speaks against the fix.
void withdraw_fix(MatchResult& result) {
  result.status = MatchStatus::kAmbiguous;
  result.fix.reset();
}

/// What the ranking found, in the words of the statistics. `searches`: how many searches the best place is the best of.
void describe_ranking(const RankedPlaces& places, double half_width_px, double searches, MatchStats& stats) {
  const RankedPlace& best = places.best;
  stats.support = best.match.evidence();
  stats.expected_features = best.match.expected;
  stats.vote_peak = best.evidence;
  stats.vote_rival = places.rival_evidence;
  stats.ncc = best.ncc;
  stats.ncc_rival = places.rival_ncc;
  stats.chip_pixels = best.compared_px;
  stats.agreement = best.agreement;
  stats.landmarks_expected = static_cast<int>(best.landmarks.expected);
  stats.landmarks_matched = static_cast<int>(best.landmarks.pairs.size());
  stats.confidence = 1 - std::min(1.0, searches * false_fix_rate(best.evidence, half_width_px));
}

bool is_ambiguous(const MatchStats& stats) {
  return stats.vote_peak - stats.vote_rival < least_lead(stats.vote_peak, stats.vote_rival);
}

/// Why the best place is not accepted as a fix, or nothing.
std::optional<MatchStatus> refusal_of_best(const MatchStats& stats, const MatchOptions& options, bool near_rival,
                                           bool outside_gate) {
  // A weak place may be confirmed by a track (flightlog/frame_track.h), which cannot tell it from a rival nearby.
  if (1 - stats.confidence > options.max_false_fix_rate) {
    return near_rival ? MatchStatus::kAmbiguous : MatchStatus::kInconsistent;
  }
  if (is_ambiguous(stats)) return MatchStatus::kAmbiguous;
  if (outside_gate) return MatchStatus::kOutsideGate;
  return std::nullopt;
}

/// The deadline has passed.
struct OutOfTime {};

/// Looks at the clock when there is a deadline, and asks whether to go on.
Checkpoint checkpoint_of(const MatchOptions& options, const std::function<bool()>& go_on) {
  const auto start = std::chrono::steady_clock::now();
  return [deadline_ms = options.deadline_ms, &go_on, start] {
    if (go_on && !go_on()) throw Interrupted{};
    if (!deadline_ms) return;
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    if (elapsed.count() >= *deadline_ms) throw OutOfTime{};
  };
}

/// While it lives the map looks at a checkpoint, too: a forged one may be read for long.
class WatchedMap {
 public:
  WatchedMap(MapReader& map, const Checkpoint& checkpoint) : map_(map) { map_.watch(checkpoint); }
  ~WatchedMap() { map_.watch({}); }
  WatchedMap(const WatchedMap&) = delete;
  WatchedMap& operator=(const WatchedMap&) = delete;

 private:
  MapReader& map_;
};

/// What may still be taken of MatchOptions::max_memory_mib.
class MemoryLeft {
 public:
  explicit MemoryLeft(const MatchOptions& options) : bytes_(options.max_memory_mib * kMib) {}

  /// Whether so much is left; it is then taken.
  bool take(double bytes) { return (bytes_ -= bytes) >= 0; }
  /// How many of so much each.
  double count(double bytes_each) const { return std::max(0.0, bytes_) / bytes_each; }

 private:
  double bytes_;
};

/// Features of the map that a search may look at: what memory is left for, and what can be compared.
double feature_limit(const MemoryLeft& memory, const PivotedFrame& described, const FeatureOptions& features) {
  const double by_memory = memory.count(bytes_of_map_feature(features));
  const double per_feature = vote_comparisons(described, 1);
  return std::min({by_memory, kMaxComparisons / std::max(1.0, per_feature), 1e9});
}

/// Of a map that does not say how good its heights are: those made before there was a place for it.
constexpr double kUnknownHeightSigma_m = 1;

/// The relief of the window, and of the ground under the aircraft where the window does not show it: an oblique view.
Relief read_relief(MapReader& map, const FrameOnGrid& rectified, const MatchPrior& prior, double window_px,
                   std::size_t max_features, const LocalMap& local, const std::vector<NearLandmark>& landmarks,
                   const MatchOptions& options, const Checkpoint& checkpoint) {
  constexpr double kAboutNadirPx = 64;
  const double sigma_px = largest_sigma_m(prior.covariance_en_m2) / rectified.gsd_m;
  LocalMap below;
  const double nadir_off_px = rectified.px_from_m(rectified.pivot_m).cwiseAbs().maxCoeff();
  if (nadir_off_px + kAboutNadirPx > window_px && local.features.size() < max_features) {
    below = read_local_map(map, *rectified.level, rectified.grid, rectified.prior_px,
                           std::min(rectified.half_width_px, 2 * sigma_px) + kAboutNadirPx,
                           max_features - local.features.size(), checkpoint);
  }
  const Eigen::Vector2d center_px = rectified.prior_px + rectified.px_from_m(rectified.pivot_m) - local.reference_px;
  std::vector<SpotHeight> spots;
  for (const NearLandmark& one : landmarks) {
    const bool inside = (one.map_px - center_px).cwiseAbs().maxCoeff() <= window_px;
    if (inside) spots.push_back({one.map_px, one.height_m});
  }
  Relief relief =
      relief_of(local, below, spots, {rectified.prior_px - local.reference_px, sigma_px, prior.height_agl_m});
  if (relief.ground.known()) {
    relief.height_sigma_m = options.elevation_sigma_m.value_or(map.elevation_sigma_m().value_or(kUnknownHeightSigma_m));
    if (relief.is_sparse) relief.height_sigma_m = std::hypot(relief.height_sigma_m, kSparseHeightSigma_m);
  }
  return relief;
}

/// The pose at the best place. Of landmarks only those count that agree with it; where features say more than these,
/// they have the pose.
std::optional<RefinedFix> refine_best(const FrameOnGrid& rectified, const PivotedFrame& described,
                                      const LocalMap& local, const MatchPrior& prior, const MatchOptions& options,
                                      const std::optional<LandmarkSearch>& landmarks, RankedPlace& best) {
  if (!landmarks || best.evidence <= best.of_features) {
    return refine_fix(rectified, described, local, prior, options, best);
  }
  auto refined = best.by_landmarks
                     ? refine_fix_by_landmarks(rectified, described, local, prior, options, *landmarks, best)
                     : refine_fix_beside_landmarks(rectified, described, local, prior, options, *landmarks, best);
  const std::size_t agreeing = refined ? refined->landmark_groups : 0;
  const double lost = landmark_evidence(*landmarks, best.landmarks.groups) - landmark_evidence(*landmarks, agreeing);
  best.evidence = std::max(best.of_features, best.evidence - lost);
  if (!best.by_landmarks || best.evidence > best.of_features || best.of_features <= 0) return refined;
  best.by_landmarks = false;
  return refine_fix(rectified, described, local, prior, options, best);
}

/// Of where the map lies at a fix. Where no tile says it, of the tile that lies worst, and at least what is taken of
/// maps that do not say.
double map_sigma_m(MapReader& map, const Fix& fix, const MatchOptions& options) {
  if (options.map_sigma_m) return *options.map_sigma_m;
  if (fix.tile_id) return map.map_sigma_m(*fix.tile_id).value_or(kUnknownMapSigma_m);
  return std::max(map.largest_map_sigma_m().value_or(0), kUnknownMapSigma_m);
}

/// A search about one heading, which is known well enough for upright descriptors. `searches`: how many such are made.
MatchResult match_heading(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                          const MatchOptions& options, double searches, const Checkpoint& checkpoint) {
  pass(checkpoint);
  MatchStats stats;
  MemoryLeft memory(options);
  if (!memory.take(bytes_to_rectify(frame))) return refused(MatchStatus::kTooUncertain, stats);
  const FrameOnGrid rectified = rectify_frame(frame, prior, camera, map, options, checkpoint);
  stats.search_half_width_m = search_half_width_m(prior, options);
  if (rectified.level != nullptr) stats.level = rectified.level->matrix.level;
  stats.gsd_m = rectified.gsd_m;
  if (rectified.refusal) return refused(*rectified.refusal, stats);
  pass(checkpoint);

  const FeatureOptions& features = map.features();
  if (!memory.take(bytes_to_describe(rectified, features))) return refused(MatchStatus::kTooUncertain, stats);
  const PivotedFrame described = describe(rectified, features, checkpoint);
  pass(checkpoint);
  if (!memory.take(chip_comparison_bytes(map, options, rectified, described))) {
    return refused(MatchStatus::kTooUncertain, stats);
  }
  const double window_px = rectified.half_width_px + described.radius_px;
  if (!memory.take(landmark_search_bytes(map, options))) return refused(MatchStatus::kTooUncertain, stats);
  if (!memory.take(ground_heights_bytes(2 * (window_px + rectified.px_from_m(rectified.pivot_m).norm())))) {
    return refused(MatchStatus::kTooUncertain, stats);
  }
  if (!memory.take(bytes_to_vote(rectified.half_width_px))) return refused(MatchStatus::kTooUncertain, stats);
  const double max_features = feature_limit(memory, described, features);
  const Eigen::Vector2d center_px = rectified.prior_px + rectified.px_from_m(rectified.pivot_m);
  LocalMap local = read_local_map(map, *rectified.level, rectified.grid, center_px, window_px,
                                  static_cast<std::size_t>(max_features), checkpoint);
  stats.frame_features = static_cast<int>(described.grid.points.size());
  stats.map_features = static_cast<int>(local.features.size());
  std::vector<NearLandmark> near =
      landmarks_near(map, options, rectified.grid, local.reference_px, center_px - local.reference_px,
                     landmark_reach(rectified.half_width_px, described.radius_px), checkpoint);
  if (local.features.size() == 0 && near.empty()) return refused(MatchStatus::kNoMap, stats);
  if (local.features.descriptor_bytes * 8 != features.descriptor_bits) {
    return refused(MatchStatus::kMapUnreadable, stats);
  }
  local.relief = read_relief(map, rectified, prior, window_px, static_cast<std::size_t>(max_features), local, near,
                             options, checkpoint);
  const SearchSpace space = search_space(rectified, local, options);
  const auto landmarks =
      look_for_landmarks(frame, prior, camera, map, rectified, described, local, space, std::move(near), checkpoint);
  stats.landmarks_seen = landmarks ? static_cast<int>(landmarks->sightings.size()) : 0;
  if (has_few_features(described, local) && stats.landmarks_seen < static_cast<int>(kLeastLandmarks)) {
    return refused(local.features.size() == 0 ? MatchStatus::kNoMap : MatchStatus::kTooFewFeatures, stats);
  }
  if (stats.map_features > max_features || search_bins(described, space) > kMaxSearchBins) {
    return refused(MatchStatus::kTooUncertain, stats);
  }
  // Over relief more scales are tried than the rate of false fixes was measured with: as many times as often.
  const double tried = searches * std::max(1.0, space.scale_sigma / options.height_sigma_fraction);
  auto chips = compare_chips(frame, prior, camera, map, options, rectified, described, local, checkpoint);
  if (chips) chips->enough_evidence = least_evidence(options.max_false_fix_rate / tried, rectified.half_width_px);
  auto places = rank_places(described, local, space, chips, landmarks, rectified.gsd_m, checkpoint);
  if (!places) return refused(MatchStatus::kInconsistent, stats);
  auto refined = refine_best(rectified, described, local, prior, options, landmarks, places->best);
  if (places->next_there && places->next_there->evidence > places->best.evidence) {
    // Landmarks that made it the best do not agree with its pose: what else speaks for this place is asked.
    auto again = refine_best(rectified, described, local, prior, options, landmarks, *places->next_there);
    if (again && places->next_there->evidence > places->best.evidence) {
      refined = std::move(again);
      places->best = *places->next_there;
    }
  }
  const bool near_rival = places->nearby && is_near_rival(places->best, *places->nearby);
  if (near_rival) {
    places->rival_evidence = std::max(places->rival_evidence, places->nearby->evidence);
  }
  describe_ranking(*places, rectified.half_width_px, tried, stats);
  if (!refined) return refused(MatchStatus::kInconsistent, stats);
  add_map_error(refined->fix, map_sigma_m(map, refined->fix, options));
  stats.inliers = refined->pose.inliers;
  stats.residual_m = refined->pose.residual_m;
  const bool outside_gate = is_outside_gate(refined->fix, prior, options);
  const auto refusal = refusal_of_best(stats, options, near_rival, outside_gate);
  MatchResult answer = refused(refusal.value_or(MatchStatus::kFix), stats);
  answer.candidate = refined->fix;
  if (!refusal) answer.fix = refined->fix;
  return answer;
}

/// Headings kHeadingStepDeg apart within two standard deviations of the prior's: first that, then the nearest.
std::vector<double> swept_headings_deg(double yaw_deg, double yaw_sigma_deg) {
  std::vector<double> headings_deg{yaw_deg};
  const double reach_deg = std::min(2 * yaw_sigma_deg, 180.0);
  for (double off_deg = kHeadingStepDeg; off_deg < reach_deg + kHeadingStepDeg / 2; off_deg += kHeadingStepDeg) {
    headings_deg.push_back(yaw_deg + off_deg);
    if (off_deg < 180) headings_deg.push_back(yaw_deg - off_deg);
  }
  return headings_deg;
}

bool is_elsewhere(const Fix& a, const Fix& b) {
  return LocalFrame(a.center).enu_from_geodetic(b.center).head<2>().norm() > kMinRivalDistance_m;
}

/// A place elsewhere that another of the `answers` found is a rival of the best one's: it takes a lead over that, too.
void count_rivals(MatchResult& best, const std::vector<MatchResult>& answers) {
  for (const MatchResult& other : answers) {
    if (!best.candidate || !other.candidate || !is_elsewhere(*best.candidate, *other.candidate)) continue;
    best.stats.vote_rival = std::max(best.stats.vote_rival, other.stats.vote_peak);
  }
  if (best.fix && is_ambiguous(best.stats)) withdraw_fix(best);
}

bool has_fix(const std::vector<MatchResult>& answers) {
  return std::any_of(answers.begin(), answers.end(), [](const MatchResult& answer) { return answer.fix.has_value(); });
}

/// The headings that a coarse look says most for are searched by features alone until one gives a fix, three at least
/// and twelve at most; the best ones again, each about the
/// heading that was found there, with chips. The best of all is the answer, and the best elsewhere its rival. The rate
/// of false fixes counts all headings: the most that any of all would say is no less than what is found among some.
/// `map_count`: how many are swept so.
MatchResult match_by_sweep(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                           const MatchOptions& options, double map_count, const Checkpoint& checkpoint) {
  const std::vector<double> headings_deg = swept_headings_deg(prior.attitude.yaw_deg, options.yaw_sigma_deg);
  const double searches = map_count * static_cast<double>(headings_deg.size());
  MatchOptions about_heading = options;
  about_heading.chips = false;
  about_heading.landmarks = false;
  about_heading.yaw_sigma_deg = kHeadingStepDeg / 4;  // two of them reach the middle between two headings
  const bool is_ranked = headings_deg.size() > kMostHeadingsSearched;
  const std::vector<double> headings_searched_deg =
      !is_ranked ? headings_deg
                 : promising_headings_deg(frame, prior, camera, map, about_heading, headings_deg, kMostHeadingsSearched,
                                          checkpoint);
  MatchPrior turned = prior;
  std::vector<MatchResult> found;
  for (const double heading_deg : headings_searched_deg) {
    turned.attitude.yaw_deg = heading_deg;
    MatchResult result = match_heading(frame, turned, camera, map, about_heading, searches, checkpoint);
    // Without a place this is no question of the heading, or only this heading has none.
    if (result.candidate || found.empty()) found.push_back(std::move(result));
    if (is_ranked && found.size() >= kHeadingsLookedAtAgain && has_fix(found)) break;
  }
  const auto by_evidence = [](const MatchResult& a, const MatchResult& b) {
    return a.stats.vote_peak > b.stats.vote_peak;
  };
  std::stable_sort(found.begin(), found.end(), by_evidence);
  if (!found.front().candidate) return found.front();
  found.resize(std::min(found.size(), kHeadingsLookedAtAgain));
  about_heading.chips = options.chips;
  about_heading.landmarks = options.landmarks;
  about_heading.yaw_sigma_deg = std::min(options.yaw_sigma_deg, kFoundYawSigmaDeg);
  for (MatchResult& result : found) {
    if (!result.candidate) continue;
    turned.attitude.yaw_deg = result.candidate->yaw_deg;
    result = match_heading(frame, turned, camera, map, about_heading, searches, checkpoint);
  }
  std::stable_sort(found.begin(), found.end(), by_evidence);
  count_rivals(found.front(), found);
  return found.front();
}

/// What one of `map_count` maps answers.
MatchResult match_on_map(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                         const MatchOptions& options, double map_count, const Checkpoint& checkpoint) {
  try {
    const WatchedMap watched(map, checkpoint);
    return options.yaw_sigma_deg <= kKnownYawSigmaDeg
               ? match_heading(frame, prior, camera, map, options, map_count, checkpoint)
               : match_by_sweep(frame, prior, camera, map, options, map_count, checkpoint);
  } catch (const OutOfTime&) {
    return refused(MatchStatus::kOutOfTime, {});
  } catch (const DataError&) {
    return refused(MatchStatus::kMapUnreadable, {});
  } catch (const UsageError&) {
    return refused(MatchStatus::kBadPrior, {});
  } catch (
      const cv::Exception& error) {  // OpenCV refuses a picture in its own way, and says so, too, that memory is out
    return refused(error.code == cv::Error::StsNoMem ? MatchStatus::kOutOfMemory : MatchStatus::kBadFrame, {});
  } catch (const std::bad_alloc&) {
    return refused(MatchStatus::kOutOfMemory, {});
  }
}

/// The map could not be searched: the frame may be on it.
bool was_not_searched(MatchStatus status) {
  return status == MatchStatus::kOutOfMemory || status == MatchStatus::kMapUnreadable ||
         status == MatchStatus::kOutOfTime || status == MatchStatus::kTooUncertain;
}

/// Whether two fixes of one frame are farther apart than their covariances let two right ones be.
bool contradict(const Fix& a, const Fix& b) {
  const Eigen::Vector2d apart_m = LocalFrame(a.center).enu_from_geodetic(b.center).head<2>();
  const Eigen::Matrix2d covariance_m2 = a.center_covariance_en_m2 + b.center_covariance_en_m2;
  return !(mahalanobis_squared(apart_m, covariance_m2) <= kInnovationGateChiSquared);
}

/// Whether the lead over rivals is still enough where another map, which is sure of the same place too, sees rivals of
/// its own: ground that was built twice since the day of the first. What both say for the place is added up, and what
/// they say for others as if that were one.
bool leads_on_both(const MatchStats& best, const MatchStats& other) {
  const double evidence = best.vote_peak + other.vote_peak;
  const double against = best.vote_rival + other.vote_rival;
  return evidence - against >= least_lead(evidence, against);
}

/// Withdraws a fix that another map speaks against.
void heed_other_maps(MatchResult& best, const std::vector<MatchResult>& answers, double max_false_fix_rate) {
  bool doubted = false;
  for (const MatchResult& other : answers) {
    if (!best.fix || !other.candidate || other.map_index == best.map_index) continue;
    const bool elsewhere = is_elsewhere(*best.fix, *other.candidate);
    const bool sure = 1 - other.stats.confidence <= max_false_fix_rate;
    doubted = doubted || (other.fix && (elsewhere || contradict(*best.fix, *other.fix))) ||
              (sure && !elsewhere && !leads_on_both(best.stats, other.stats));
  }
  count_rivals(best, answers);
  if (best.fix && doubted) withdraw_fix(best);
}

/// The answer of several maps: what match() says of them.
MatchResult answer_of_maps(std::vector<MatchResult>& answers, const MatchOptions& options) {
  std::vector<MatchStatus> statuses;
  for (MatchResult& answer : answers) {
    answer.map_index = statuses.size();
    statuses.push_back(answer.status);
  }
  const auto rank = [](const MatchResult& answer) {
    return std::tuple(answer.fix.has_value(), was_not_searched(answer.status),
                      answer.candidate ? answer.stats.vote_peak : -1.0, answer.status);
  };
  MatchResult& best = *std::max_element(answers.begin(), answers.end(),
                                        [&](const MatchResult& a, const MatchResult& b) { return rank(a) < rank(b); });
  heed_other_maps(best, answers, options.max_false_fix_rate);
  best.map_statuses = std::move(statuses);
  for (std::optional<Fix>* const place : {&best.fix, &best.candidate}) {
    if (*place) (*place)->map_error_is_shared = answers.size() == 1;
  }
  return best;
}

}  // namespace

MatchResult match(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                  const MatchOptions& options, const std::function<bool()>& go_on) {
  MapReader* const only = &map;
  return match(frame, prior, camera, std::span(&only, 1), options, go_on);
}

MatchResult match(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, std::span<MapReader* const> maps,
                  const MatchOptions& options, const std::function<bool()>& go_on) {
  if (!options_are_good(options)) return refused(MatchStatus::kBadOptions, {});
  if (!prior_is_good(prior)) return refused(MatchStatus::kBadPrior, {});
  if (maps.empty()) return refused(MatchStatus::kNoMap, {});
  try {
    const Checkpoint checkpoint = checkpoint_of(options, go_on);
    std::vector<MatchResult> answers;
    for (MapReader* const map : maps) {
      answers.push_back(
          match_on_map(frame, prior, camera, *map, options, static_cast<double>(maps.size()), checkpoint));
    }
    return answer_of_maps(answers, options);
  } catch (const std::bad_alloc&) {
    return refused(MatchStatus::kOutOfMemory, {});
  } catch (const UsageError&) {  // a place that is not on Earth
    return refused(MatchStatus::kBadPrior, {});
  }
}

}  // namespace pilotage
