#include "pilotage/match/landmark_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <Eigen/Cholesky>
#include <opencv2/core.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/statistics.h"
#include "pilotage/match/match_confidence.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

/// Of a place that features refined, and of what is left of the frame's pose there: with a sighting's own error it
/// makes the tolerance, at this many of them.
constexpr double kPlaceSigma_m = 1;
constexpr double kToleranceSigmas = 3;
/// Of sightings with landmarks, in voting.
constexpr double kMaxPairComparisons = 2e8;
/// Turns and scales that are looked at, in σ of the prior.
constexpr double kPoseSigmas = 2.5;
/// Of a class on a frame: the strongest.
constexpr std::size_t kMaxSightings = 64;
constexpr double kLandmarkNoisePx = 1;
/// Landmarks of a class that hang together over more than so many steps are a crowd.
constexpr double kCrowdLinks = 3;
/// A frame is worse than the imagery of the other date, on which P(detect) was measured: this part of it is counted on.
/// Modelled, not measured.
constexpr double kDetectedOnFrames = 0.8;

bool are_wanted(const MapReader& map, const MatchOptions& options) {
  return options.landmarks && map.has_landmarks();
}

/// East and north of a place; nothing of the other side of the Earth, which lies below.
std::optional<Vector2d> enu_on_this_side(const LocalFrame& frame, GeodeticPoint place) {
  constexpr double kFarBelow_m = 1e5;  // a thousand kilometres off
  const Eigen::Vector3d enu_m = frame.enu_from_geodetic(place);
  if (!(enu_m.z() > -kFarBelow_m)) return std::nullopt;
  return Vector2d(enu_m.head<2>());
}

/// Where a sighting lies from the pivot when it is that landmark: on ground as high as the landmark's.
Vector2d on_ground_of(const PivotedFrame& frame, const LandmarkSighting& sighting, const NearLandmark& landmark) {
  return frame.stretched(sighting.from_pivot_px, landmark.stretch);
}

/// How far a prior's turn and scale, two of their σ, move a place, for each pixel from the pivot.
double open_per_px(const SearchSpace& space) {
  return 2 * (space.yaw_sigma_rad + space.scale_sigma);
}

/// Whether turns_and_scales() counted it.
bool is_searched(const Placement& placement, const SearchSpace& space) {
  return (placement.center_px - space.center_px).cwiseAbs().maxCoeff() <= space.half_width_px + kPeakSeparationPx &&
         std::abs(placement.yaw_rad) <= kPoseSigmas * space.yaw_sigma_rad &&
         std::abs(placement.scale - 1) <= kPoseSigmas * space.scale_sigma;
}

/// Turn, scale and centre by least squares over pairs, with the prior's turn and scale.
Placement fitted(const PivotedFrame& frame, const LandmarkSearch& search, const SearchSpace& space,
                 const std::vector<LandmarkPair>& pairs) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  const auto add = [&](const Eigen::Vector4d& row, double value, double sigma) {
    normal += row * row.transpose() / (sigma * sigma);
    right += row * value / (sigma * sigma);
  };
  for (const LandmarkPair& pair : pairs) {
    const NearLandmark& landmark = search.near[pair.near];
    const Vector2d o = on_ground_of(frame, search.sightings[pair.sighting], landmark);
    add({1, 0, o.x(), -o.y()}, landmark.map_px.x(), kLandmarkNoisePx);
    add({0, 1, o.y(), o.x()}, landmark.map_px.y(), kLandmarkNoisePx);
  }
  add({0, 0, 1, 0}, 1, std::max(space.scale_sigma, 1e-4));
  add({0, 0, 0, 1}, 0, std::max(space.yaw_sigma_rad, 1e-4));
  const Eigen::Vector4d solution = normal.ldlt().solve(right);
  return {solution.head<2>(), std::atan2(solution(3), solution(2)), std::hypot(solution(2), solution(3))};
}

/// Sightings of a place that lie within their tolerance, made wider by `open` for each pixel from `about_px`.
std::vector<LandmarkPair> pairs_at(const PivotedFrame& frame, const LandmarkSearch& search, const Placement& placement,
                                   double open, const Vector2d& about_px, const Checkpoint& checkpoint) {
  struct Near {
    double distance_px;
    LandmarkPair pair;
  };
  const PlacementTransform transform(placement);
  std::vector<Near> all;
  for (std::size_t i = 0; i < search.sightings.size(); ++i) {
    pass(checkpoint);
    const LandmarkSighting& sighting = search.sightings[i];
    const double tolerance_px =
        search.tolerance_px[sighting.detector] + open * (sighting.from_pivot_px - about_px).norm();
    for (std::size_t j = 0; j < search.near.size(); ++j) {
      const NearLandmark& landmark = search.near[j];
      if (landmark.detector != sighting.detector) continue;
      const Vector2d place_px = transform.map_from_frame(on_ground_of(frame, sighting, landmark));
      const double distance_px = (place_px - landmark.map_px).norm();
      if (distance_px <= tolerance_px) all.push_back({distance_px, {i, j}});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Near& a, const Near& b) { return a.distance_px < b.distance_px; });
  std::vector<bool> sighting_taken(search.sightings.size(), false);
  std::vector<bool> landmark_taken(search.near.size(), false);
  std::vector<LandmarkPair> pairs;
  for (const Near& one : all) {
    if (sighting_taken[one.pair.sighting] || landmark_taken[one.pair.near]) continue;
    sighting_taken[one.pair.sighting] = true;
    landmark_taken[one.pair.near] = true;
    pairs.push_back(one.pair);
  }
  return pairs;
}

/// What a detector finds on the frame as it wants it: north up on the grid, at its pixels; what is not ground has the
/// mean of the rest.
struct Looked {
  std::vector<Vector2d> places_m;
  std::vector<Vector2d> corners_m;  // of what it looked at, two
  bool all = true;                  // what it found is kept
};

Looked look(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, const FrameOnGrid& rectified,
            const LandmarkDetector& detector, const Checkpoint& checkpoint) {
  RectifyOptions rectify;
  rectify.gsd_m = detector.gsd_m;
  rectify.max_size_px = kMaxLookedAtPx;
  RectifiedFrame laid =
      ortho_rectify(frame, camera, attitude_on_grid(prior.attitude, rectified.grid), prior.height_agl_m, rectify);
  Looked looked;
  if (laid.status != RectifyStatus::kOk) return looked;
  looked.corners_m = {laid.ground_from_pixel({0, 0}), laid.ground_from_pixel({static_cast<double>(laid.gray.cols),
                                                                              static_cast<double>(laid.gray.rows)})};
  laid.gray.setTo(cv::mean(laid.gray, laid.valid), ~laid.valid);
  const auto hits = detect_landmarks(detector, laid.gray, laid.gsd_m, detector.threshold, kMaxSightings, checkpoint);
  looked.all = hits.size() < kMaxSightings;
  for (const LandmarkHit& hit : hits) {
    const cv::Point pixel(static_cast<int>(std::floor(hit.center_px.x())),
                          static_cast<int>(std::floor(hit.center_px.y())));
    const bool inside = cv::Rect(0, 0, laid.gray.cols, laid.gray.rows).contains(pixel);
    if (inside && laid.valid.at<std::uint8_t>(pixel) != 0) {
      looked.places_m.push_back(laid.ground_from_pixel(hit.center_px));
    }
  }
  return looked;
}

/// Whether the frame, placed so, shows all that the landmark's detector looks at, and that should be seen.
bool is_shown(const PivotedFrame& frame, const LandmarkSearch& search, const NearLandmark& landmark,
              const PlacementTransform& placement) {
  if (!landmark.found || !(search.p_detect[landmark.detector] > 0)) return false;
  const FrameGrid& grid = frame.grid;
  const Vector2d middle =
      frame.stretched(placement.frame_from_map(landmark.map_px), 1 / landmark.stretch) + frame.pivot_px;
  for (const Vector2d& corner : {Vector2d(-1, -1), Vector2d(1, -1), Vector2d(-1, 1), Vector2d(1, 1)}) {
    const Vector2d at_px = middle + landmark.half_side_px * corner;
    if (!search.looked_at_px[landmark.detector].contains(at_px - frame.pivot_px)) return false;
    const Vector2d point = (at_px - Vector2d::Constant(0.5)) / grid.step_px;
    const double column = std::round(point.x());
    const double row = std::round(point.y());
    if (!(column >= 0 && row >= 0 && column < grid.columns && row < grid.rows)) return false;
    if (grid.at(static_cast<int>(column), static_cast<int>(row)) < 0) return false;
  }
  return true;
}

/// Indices of sightings: the strongest of each class, the next of each, and so on. Those of a class stand together,
/// strongest first.
std::vector<std::size_t> strongest_of_each_class(const std::vector<LandmarkSighting>& sightings) {
  std::vector<std::pair<std::size_t, std::size_t>> ranked;  // rank within its class, index
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const bool same = i > 0 && sightings[i].detector == sightings[i - 1].detector;
    ranked.emplace_back(same ? ranked.back().first + 1 : 0, i);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::size_t> order;
  for (const auto& [rank, index] : ranked) order.push_back(index);
  return order;
}

/// Groups of the landmarks of pairs, each counted once.
std::size_t count_groups(const LandmarkSearch& search, const std::vector<LandmarkPair>& pairs) {
  std::set<std::size_t> groups;
  for (const LandmarkPair& pair : pairs) groups.insert(search.near[pair.near].group);
  return groups.size();
}

/// Landmarks from left to right.
std::vector<std::size_t> sorted_by_x(const std::vector<NearLandmark>& near) {
  std::vector<std::size_t> order(near.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return near[a].map_px.x() < near[b].map_px.x(); });
  return order;
}

/// Whether two other landmarks of these classes differ as these two do, within the tolerance.
bool difference_repeats(const LandmarkSearch& search, const std::vector<std::size_t>& by_x, std::size_t from,
                        std::size_t to) {
  const NearLandmark& a = search.near[from];
  const NearLandmark& b = search.near[to];
  const double tolerance_px = std::max(search.tolerance_px[a.detector], search.tolerance_px[b.detector]);
  for (std::size_t i = 0; i < search.near.size(); ++i) {
    if (search.near[i].detector != a.detector) continue;
    const Vector2d expected_px = search.near[i].map_px + (b.map_px - a.map_px);
    const auto first =
        std::lower_bound(by_x.begin(), by_x.end(), expected_px.x() - tolerance_px,
                         [&](std::size_t one, double x_px) { return search.near[one].map_px.x() < x_px; });
    for (auto at = first; at != by_x.end(); ++at) {
      const NearLandmark& other = search.near[*at];
      if (other.map_px.x() > expected_px.x() + tolerance_px) break;
      if (other.detector != b.detector || (i == from && *at == to) || (i == to && *at == from)) continue;
      if ((other.map_px - expected_px).norm() <= tolerance_px) return true;
    }
  }
  return false;
}

/// The most of them that lie along one line, within the tolerance; all where there are two or fewer.
std::size_t most_in_line(const LandmarkSearch& search, const std::vector<std::size_t>& near) {
  std::size_t most = std::min<std::size_t>(near.size(), 2);
  for (std::size_t i = 0; i < near.size(); ++i) {
    for (std::size_t j = i + 1; j < near.size(); ++j) {
      const Vector2d from_px = search.near[near[i]].map_px;
      const Vector2d along = (search.near[near[j]].map_px - from_px).normalized();
      const auto in_line = std::count_if(near.begin(), near.end(), [&](std::size_t one) {
        const Vector2d off_px = search.near[one].map_px - from_px;
        const double beside_px = std::abs(along.x() * off_px.y() - along.y() * off_px.x());
        return beside_px <= 2 * search.tolerance_px[search.near[one].detector];
      });
      most = std::max(most, static_cast<std::size_t>(in_line));
    }
  }
  return most;
}

/// −ln P(M ≥ missed) where each of the groups is missed with its chance.
double evidence_of_missing(const std::vector<double>& p_missed, std::size_t missed) {
  if (missed == 0) return 0;
  const std::vector<double> chance = poisson_binomial(p_missed);
  const double tail = std::accumulate(chance.begin() + static_cast<std::ptrdiff_t>(missed), chance.end(), 0.0);
  return -std::log(std::clamp(tail, 1e-30, 1.0));
}

/// How many sightings lie on landmarks at a place that has nothing to do with them, on average.
double expected_by_chance(const LandmarkSearch& search) {
  double mean = 0;
  for (const LandmarkSighting& sighting : search.sightings) {
    const double tolerance_px = search.tolerance_px[sighting.detector];
    mean += search.landmarks_in_px2[sighting.detector] * std::numbers::pi * tolerance_px * tolerance_px;
  }
  return mean;
}

/// Numbers of groups, from 0: landmarks of one hang together in steps of at most `link_px` between those that `may`.
template <class MayLink>
std::vector<std::size_t> hanging_together(double link_px, const std::vector<NearLandmark>& landmarks,
                                          const MayLink& may, const Checkpoint& checkpoint) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> group_of(landmarks.size(), kNone);
  std::size_t groups = 0;
  std::vector<std::size_t> to_visit;
  for (std::size_t first = 0; first < landmarks.size(); ++first) {
    if (group_of[first] != kNone) continue;
    group_of[first] = groups;
    to_visit.push_back(first);
    while (!to_visit.empty()) {
      pass(checkpoint);
      const NearLandmark& here = landmarks[to_visit.back()];
      to_visit.pop_back();
      for (std::size_t i = first; i < landmarks.size(); ++i) {
        if (group_of[i] != kNone || !((landmarks[i].map_px - here.map_px).norm() <= link_px)) continue;
        if (!may(landmarks[i], here)) continue;
        group_of[i] = groups;
        to_visit.push_back(i);
      }
    }
    ++groups;
  }
  return group_of;
}

}  // namespace

double landmark_tolerance_m(const MapDetector& detector, double gsd_m) {
  return kToleranceSigmas * std::hypot(detector.sigma_m, std::max(kPlaceSigma_m, gsd_m));
}

double looked_at_half_side_m(const MapDetector& detector, double length_m) {
  return 0.5 * detector.detector.context * length_m;
}

double p_seen_on_frame(const MapDetector& detector) {
  return kDetectedOnFrames * detector.p_detect;
}

std::vector<double> landmark_densities(const std::vector<NearLandmark>& landmarks, std::size_t detectors,
                                       double reach_px, double radius_px, const Checkpoint& checkpoint) {
  std::vector<double> counts(detectors, 0);
  std::vector<double> beside(detectors, 0);  // of all landmarks, those of their class within the radius
  for (const NearLandmark& one : landmarks) {
    pass(checkpoint);
    counts[one.detector] += 1;
    for (const NearLandmark& other : landmarks) {
      const bool is_beside =
          &one != &other && one.detector == other.detector && (one.map_px - other.map_px).norm() <= radius_px;
      beside[one.detector] += is_beside ? 1 : 0;
    }
  }
  std::vector<double> densities;
  for (std::size_t i = 0; i < detectors; ++i) {
    const double over_all = (counts[i] + 1) / (std::numbers::pi * reach_px * reach_px);
    const double about_each = (beside[i] / std::max(1.0, counts[i]) + 1) / (std::numbers::pi * radius_px * radius_px);
    densities.push_back(std::max(over_all, about_each));
  }
  return densities;
}

double landmark_reach(double half_width, double frame_radius) {
  return std::numbers::sqrt2 * half_width + 1.2 * frame_radius;
}

std::vector<NearLandmark> landmarks_near(MapReader& map, const MatchOptions& options, const LocalGrid& grid,
                                         const Vector2d& reference_px, const Vector2d& center_px, double reach_px,
                                         const Checkpoint& checkpoint) {
  if (!are_wanted(map, options)) return {};
  const std::shared_ptr<const MapLandmarks> stored = map.landmarks();
  std::vector<NearLandmark> near;
  for (const MapLandmark& landmark : stored->landmarks) {
    pass(checkpoint);
    const auto enu_m = enu_on_this_side(grid.frame, landmark.place);
    if (!enu_m) continue;
    NearLandmark one;
    one.detector = landmark.detector;
    one.map_px = grid.px_from_enu(*enu_m) - reference_px;
    if (!((one.map_px - center_px).norm() <= reach_px)) continue;
    one.height_m = landmark.ground_height_m;
    one.length_m = landmark.length_m;
    one.half_side_px = looked_at_half_side_m(stored->detectors[landmark.detector], landmark.length_m) / grid.gsd_m();
    one.found = landmark.found;
    near.push_back(one);
    if (near.size() > kMaxNearLandmarks) return {};
  }
  return near;
}

bool has_landmark_within(MapReader& map, const MatchOptions& options, GeodeticPoint point, double radius_m,
                         const Checkpoint& checkpoint) {
  if (!are_wanted(map, options)) return false;
  const LocalFrame frame(point);
  const std::shared_ptr<const MapLandmarks> stored = map.landmarks();
  return std::any_of(stored->landmarks.begin(), stored->landmarks.end(), [&](const MapLandmark& landmark) {
    pass(checkpoint);
    const auto enu_m = enu_on_this_side(frame, landmark.place);
    return enu_m && enu_m->norm() <= radius_m;
  });
}

std::optional<LandmarkSearch> look_for_landmarks(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                                 MapReader& map, const FrameOnGrid& rectified,
                                                 const PivotedFrame& described, const LocalMap& local,
                                                 const SearchSpace& space, std::vector<NearLandmark> near,
                                                 const Checkpoint& checkpoint) {
  if (near.empty()) return std::nullopt;
  const std::shared_ptr<const MapLandmarks> stored = map.landmarks();
  const std::size_t detectors = stored->detectors.size();
  LandmarkSearch search;
  const double reach_px = landmark_reach(space.half_width_px, described.radius_px);
  for (NearLandmark& one : near) {
    if (!local.relief.ground.known()) break;
    one.stretch = std::isfinite(one.height_m) ? local.relief.stretch_of_height(one.height_m)
                                              : local.relief.stretch_at(one.map_px);
  }
  std::vector<double> counts(detectors, 0);
  const double link_px = kLandmarkGroup_m / rectified.gsd_m;
  const std::vector<bool> crowded = in_crowds(link_px, near, checkpoint);
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (crowded[i]) continue;
    search.near.push_back(near[i]);
    counts[near[i].detector] += 1;
  }
  if (search.near.empty()) return std::nullopt;
  group_landmarks(link_px, search.near, checkpoint);
  search.landmarks_in_px2 = landmark_densities(search.near, detectors, reach_px, described.radius_px, checkpoint);
  for (std::size_t i = 0; i < detectors; ++i) {
    const MapDetector& one = stored->detectors[i];
    search.sigma_m.push_back(one.sigma_m);
    search.p_detect.push_back(p_seen_on_frame(one));
    search.tolerance_px.push_back(landmark_tolerance_m(one, rectified.gsd_m) / rectified.gsd_m);
    search.looked_at_px.emplace_back();
    if (counts[i] == 0) continue;
    pass(checkpoint);
    const Looked looked = look(frame, prior, camera, rectified, one.detector, checkpoint);
    if (!looked.all) search.p_detect.back() = 0;
    for (const Vector2d& corner_m : looked.corners_m) {
      search.looked_at_px.back().extend(rectified.px_from_m(corner_m - rectified.pivot_m));
    }
    for (const Vector2d& place_m : looked.places_m) {
      search.sightings.push_back({i, rectified.px_from_m(place_m - rectified.pivot_m)});
    }
  }
  if (search.sightings.empty()) return std::nullopt;
  search.turns_and_scales = turns_and_scales(search, space);
  return search;
}

double turns_and_scales(const LandmarkSearch& search, const SearchSpace& space) {
  const double least_tolerance_px = *std::min_element(search.tolerance_px.begin(), search.tolerance_px.end());
  double farthest_px = 0;
  for (const LandmarkSighting& sighting : search.sightings) {
    farthest_px = std::max(farthest_px, sighting.from_pivot_px.norm());
  }
  // Each over kPoseSigmas to both sides, in steps that move the farthest sighting by its tolerance.
  const auto steps = [&](double sigma) {
    return std::max(1.0, 2 * kPoseSigmas * sigma * farthest_px / least_tolerance_px);
  };
  return steps(space.yaw_sigma_rad) * steps(space.scale_sigma);
}

double landmark_search_bytes(const MapReader& map, const MatchOptions& options) {
  if (!are_wanted(map, options)) return 0;
  // Pictures, and histograms of 18 and cells of 31 numbers and their margins, of cells of four pixels at the least.
  const double pixels = double{kMaxLookedAtPx} * kMaxLookedAtPx;
  return pixels * (6 + 1.3 * 4.0 * (18 + kFhogPlanes + 4) / 16);
}

std::vector<LandmarkPair> pair_landmarks(const PivotedFrame& frame, const LandmarkSearch& search,
                                         const Placement& placement, const Checkpoint& checkpoint) {
  return pairs_at(frame, search, placement, 0, {0, 0}, checkpoint);
}

void group_landmarks(double link_px, std::vector<NearLandmark>& landmarks, const Checkpoint& checkpoint) {
  const auto any = [](const NearLandmark&, const NearLandmark&) { return true; };
  const std::vector<std::size_t> groups = hanging_together(link_px, landmarks, any, checkpoint);
  for (std::size_t i = 0; i < landmarks.size(); ++i) landmarks[i].group = groups[i];
}

std::vector<bool> in_crowds(double link_px, const std::vector<NearLandmark>& landmarks, const Checkpoint& checkpoint) {
  const auto same_class = [](const NearLandmark& a, const NearLandmark& b) { return a.detector == b.detector; };
  const std::vector<std::size_t> groups = hanging_together(link_px, landmarks, same_class, checkpoint);
  std::vector<Eigen::AlignedBox2d> extents(landmarks.size());
  for (std::size_t i = 0; i < landmarks.size(); ++i) extents[groups[i]].extend(landmarks[i].map_px);
  std::vector<bool> crowded;
  for (const std::size_t group : groups) crowded.push_back(extents[group].diagonal().norm() > kCrowdLinks * link_px);
  return crowded;
}

std::size_t independent_groups(const LandmarkSearch& search, const std::vector<LandmarkPair>& pairs) {
  const std::vector<std::size_t> by_x = sorted_by_x(search.near);
  std::vector<std::size_t> counted;  // of search.near
  for (const LandmarkPair& pair : pairs) {
    if (counted.size() == kMostGroups) break;
    const bool says_nothing_new = std::any_of(counted.begin(), counted.end(), [&](std::size_t other) {
      return search.near[other].group == search.near[pair.near].group ||
             difference_repeats(search, by_x, other, pair.near);
    });
    if (!says_nothing_new) counted.push_back(pair.near);
  }
  const std::size_t in_line = most_in_line(search, counted);
  return counted.size() - in_line + std::min<std::size_t>(in_line, 2);
}

LandmarkView view_landmarks(const PivotedFrame& frame, const LandmarkSearch& search, const Placement& placement,
                            const Checkpoint& checkpoint) {
  LandmarkView view;
  view.pairs = pair_landmarks(frame, search, placement, checkpoint);
  view.groups = independent_groups(search, view.pairs);
  view.expected = view.pairs.size();
  std::vector<bool> seen(search.near.size(), false);
  for (const LandmarkPair& pair : view.pairs) seen[pair.near] = true;
  const PlacementTransform transform(placement);
  struct Group {
    double p_detect = 0;  // of the landmark that is seen best
    bool seen = false;
  };
  std::map<std::size_t, Group> shown;
  for (std::size_t i = 0; i < search.near.size(); ++i) {
    const NearLandmark& landmark = search.near[i];
    const bool is_expected = is_shown(frame, search, landmark, transform);
    if (!seen[i] && is_expected) ++view.expected;
    if (!seen[i] && !is_expected) continue;
    Group& group = shown[landmark.group];
    group.p_detect = std::max(group.p_detect, search.p_detect[landmark.detector]);
    group.seen = group.seen || seen[i];
  }
  std::vector<double> p_missed;
  std::size_t missed = 0;
  for (const auto& [number, group] : shown) {
    p_missed.push_back(1 - group.p_detect);
    missed += group.seen ? 0 : 1;
  }
  view.against = evidence_of_missing(p_missed, missed);
  return view;
}

std::vector<Placement> landmark_places(const PivotedFrame& frame, const LandmarkSearch& search,
                                       const SearchSpace& space, std::size_t count, double min_distance_px,
                                       const Checkpoint& checkpoint) {
  struct Found {
    Placement placement;
    std::size_t groups = 0;
  };
  std::vector<Found> found;
  double comparisons = 0;
  for (const std::size_t i : strongest_of_each_class(search.sightings)) {
    const LandmarkSighting& sighting = search.sightings[i];
    for (const NearLandmark& landmark : search.near) {
      if (landmark.detector != sighting.detector) continue;
      Placement placement;
      placement.center_px = landmark.map_px - on_ground_of(frame, sighting, landmark);
      const double off_px = (placement.center_px - space.center_px).cwiseAbs().maxCoeff();
      if (off_px > space.half_width_px + open_per_px(space) * sighting.from_pivot_px.norm()) continue;
      comparisons += static_cast<double>(search.sightings.size()) * static_cast<double>(search.near.size());
      if (comparisons > kMaxPairComparisons) break;
      const auto agreeing = pairs_at(frame, search, placement, open_per_px(space), sighting.from_pivot_px, checkpoint);
      if (count_groups(search, agreeing) < kLeastLandmarks) continue;
      placement = fitted(frame, search, space, agreeing);
      if (!is_searched(placement, space)) continue;
      const std::size_t groups = count_groups(search, pair_landmarks(frame, search, placement, checkpoint));
      if (groups >= kLeastLandmarks) found.push_back({placement, groups});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.groups > b.groups; });
  std::vector<Placement> places;
  for (const Found& one : found) {
    if (places.size() == count) break;
    const bool again = std::any_of(places.begin(), places.end(), [&](const Placement& other) {
      return (other.center_px - one.placement.center_px).norm() <= min_distance_px;
    });
    if (!again) places.push_back(one.placement);
  }
  return places;
}

double landmark_evidence(const LandmarkSearch& search, std::size_t groups) {
  if (groups < kLeastLandmarks) return 0;
  double mean_in_window = 0;  // pairs that put the frame somewhere in the window
  for (const LandmarkSighting& sighting : search.sightings) {
    mean_in_window += search.landmarks_in_px2[sighting.detector] * std::pow(2 * kCalibratedHalfWidthPx, 2);
  }
  const auto k = static_cast<double>(groups);
  const double ln_rate = std::log(mean_in_window * search.turns_and_scales) +
                         (k - 1) * std::log(4 * expected_by_chance(search)) - std::lgamma(k + 1);
  return std::max(0.0, -ln_rate);
}

double evidence_of_landmarks(double chips_against, const LandmarkSearch& search, const LandmarkView& view) {
  return std::max(0.0, landmark_evidence(search, view.groups) - view.against - chips_against);
}

}  // namespace pilotage
