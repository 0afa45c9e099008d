#include "pilotage/report/landmark_prospects.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <set>

#include <Eigen/Geometry>

#include "pilotage/base/angle.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/utf8.h"
#include "pilotage/camera/projection.h"
#include "pilotage/match/landmark_matching.h"
#include "pilotage/match/match.h"
#include "pilotage/match/match_confidence.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

constexpr int kHeadings = 8;           // over half a turn: turned by the other half a frame shows the same
constexpr long kMostFalseAlarms = 64;  // that are thought of on a frame: with so many no place stands out

/// Landmarks on the grid of the ground.
class LandmarksOnGrid {
 public:
  struct One {
    Vector2d point_m{0, 0};
    std::size_t index = 0;  ///< Of MapLandmarks::landmarks.
  };

  LandmarksOnGrid(const Crs& crs, const MapLandmarks& landmarks) {
    const CrsTransform transform(crs);
    for (std::size_t i = 0; i < landmarks.landmarks.size(); ++i) {
      const auto point_m = transform.map_from_geodetic(landmarks.landmarks[i].place);
      if (point_m) from_left_.push_back({*point_m, i});
    }
    std::stable_sort(from_left_.begin(), from_left_.end(),
                     [](const One& a, const One& b) { return a.point_m.x() < b.point_m.x(); });
  }

  std::vector<One> within(const Vector2d& middle_m, double reach_m) const {
    const auto by_x = [](const One& one, double x_m) { return one.point_m.x() < x_m; };
    const auto first = std::lower_bound(from_left_.begin(), from_left_.end(), middle_m.x() - reach_m, by_x);
    const auto last = std::lower_bound(first, from_left_.end(), middle_m.x() + reach_m, by_x);
    std::vector<One> found;
    std::copy_if(first, last, std::back_inserter(found),
                 [&](const One& one) { return (one.point_m - middle_m).norm() <= reach_m; });
    return found;
  }

 private:
  std::vector<One> from_left_;
};

/// The middle of the heights above ground that a level is for.
double flown_agl_m(const GridLevel& level) {
  return (level.min_agl_m + level.max_agl_m) / 2;
}

/// Whether the detector sees its landmarks on pixels of the camera from there.
bool is_resolved(const MapDetector& detector, const Camera& camera, double agl_m) {
  const GroundSampleDistance pixel = gsd_m(camera, agl_m);
  return std::max(pixel.across_m, pixel.along_m) <= kCoarsestOfDetector * detector.detector.gsd_m;
}

/// A frame about the middle of a tile, and the search around it.
struct Frame {
  Vector2d middle_m{0, 0};
  Vector2d half_m{0, 0};     // of its sides
  double search_half_m = 0;  // of the search
  double gsd_m = 0;

  double radius_m() const { return half_m.norm(); }
  /// Landmarks that a frame of the search may show.
  double reach_m() const { return landmark_reach(search_half_m, radius_m()); }
};

Frame frame_over(const Ground& ground, const GroundTile& tile, const Camera& camera, double search_radius_m,
                 const MatchOptions& options) {
  const GridLevel& level = ground.level_of(tile);
  const double agl_m = flown_agl_m(level);
  const Footprint shape = footprint(camera, Attitude{}, agl_m);
  Frame frame;
  frame.middle_m = tile.bounds.center_m();
  frame.half_m = Vector2d(tile.bounds.width_m(), tile.bounds.height_m()) / 2;
  if (shape.across_m > 0 && shape.along_m > 0) frame.half_m = Vector2d(shape.across_m, shape.along_m) / 2;
  frame.search_half_m = search_radius_m + 2 * agl_m * std::tan(options.attitude_sigma_deg * kRadPerDeg);
  frame.gsd_m = level.gsd_m;
  return frame;
}

/// Landmarks around a frame that stand in no crowd and whose detector sees with the camera's pixels.
struct NearFrame {
  std::vector<NearLandmark> near;    // from the frame's middle, grouped
  std::vector<std::size_t> numbers;  // indices of MapLandmarks::landmarks
  std::vector<double> in_px2;        // by detector: landmark_densities()
  std::vector<bool> has_class;       // by detector
};

NearFrame look_around(const Frame& frame, const MapLandmarks& landmarks, const LandmarksOnGrid& on_grid,
                      const std::vector<bool>& resolved) {
  NearFrame around;
  around.has_class.resize(landmarks.detectors.size(), false);
  std::vector<NearLandmark> all;
  std::vector<std::size_t> numbers;
  for (const LandmarksOnGrid::One& one : on_grid.within(frame.middle_m, frame.reach_m())) {
    const MapLandmark& landmark = landmarks.landmarks[one.index];
    const MapDetector& detector = landmarks.detectors[landmark.detector];
    if (!resolved[landmark.detector]) continue;
    NearLandmark near;
    near.detector = landmark.detector;
    near.map_px = (one.point_m - frame.middle_m) / frame.gsd_m;
    near.half_side_px = looked_at_half_side_m(detector, landmark.length_m) / frame.gsd_m;
    near.found = landmark.found;
    all.push_back(near);
    numbers.push_back(one.index);
  }
  if (all.size() > kMaxNearLandmarks) return {};
  const double link_px = kLandmarkGroup_m / frame.gsd_m;
  const std::vector<bool> crowded = in_crowds(link_px, all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (crowded[i]) continue;
    around.near.push_back(all[i]);
    around.numbers.push_back(numbers[i]);
    around.has_class[all[i].detector] = true;
  }
  if (around.near.size() < kLeastLandmarks) return around;
  group_landmarks(link_px, around.near);
  around.in_px2 = landmark_densities(around.near, landmarks.detectors.size(), frame.reach_m() / frame.gsd_m,
                                     frame.radius_m() / frame.gsd_m);
  return around;
}

/// Which of them a frame at this heading shows whole and the detector looks at, and that were found on the other date.
/// The square that it looks at is north up, as the frame is laid.
std::vector<std::size_t> shown_by(const Frame& frame, double heading_rad, const NearFrame& around,
                                  const MapLandmarks& landmarks) {
  const Eigen::Rotation2Dd to_frame(heading_rad);
  const double of_square = std::abs(std::cos(heading_rad)) + std::abs(std::sin(heading_rad));
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < around.near.size(); ++i) {
    const NearLandmark& one = around.near[i];
    const Vector2d off_m = (to_frame * one.map_px).cwiseAbs() * frame.gsd_m;
    const double half_side_m = one.half_side_px * frame.gsd_m;
    const double looked_at_m = kMaxLookedAtPx / 2.0 * landmarks.detectors[one.detector].detector.gsd_m;
    if (!one.found || one.map_px.cwiseAbs().maxCoeff() * frame.gsd_m + half_side_m > looked_at_m) continue;
    if (((off_m.array() + half_side_m * of_square) <= frame.half_m.array()).all()) shown.push_back(i);
  }
  return shown;
}

/// The chance that so many groups are seen that their evidence, less what the others say by not being seen, is
/// enough. Of all, `alike` say nothing of their own, and these are taken to be among those that are seen.
double p_of_fix(const LandmarkSearch& search, const std::vector<double>& p_seen, std::size_t alike,
                double search_half_px, double max_false_fix_rate) {
  const std::vector<double> p_count = poisson_binomial(p_seen);
  double p_fix = 0;
  double p_so_few = 0;  // so many, or fewer, are seen: what the missing ones say
  for (std::size_t k = 0; k < p_count.size(); ++k) {
    p_so_few += p_count[k];
    const bool all_seen = k + 1 == p_count.size();
    const double against = all_seen ? 0 : -std::log(std::clamp(p_so_few, 1e-30, 1.0));
    const std::size_t groups = std::min(k - std::min(k, alike), kMostGroups);
    const double evidence = landmark_evidence(search, groups) - against;
    if (false_fix_rate(evidence, search_half_px) <= max_false_fix_rate) p_fix += p_count[k];
  }
  return std::min(1.0, p_fix);
}

double p_fix_by(const std::vector<std::size_t>& shown, const Frame& frame, const NearFrame& around,
                const MapLandmarks& landmarks, const MatchOptions& options) {
  LandmarkSearch search;
  std::vector<LandmarkPair> pairs;         // if all are seen
  std::map<std::size_t, double> p_unseen;  // of groups that the frame may see
  const double radius_px = frame.radius_m() / frame.gsd_m;
  for (const std::size_t i : shown) {
    const NearLandmark& one = around.near[i];
    search.sightings.push_back({one.detector, {radius_px, 0}});
    pairs.push_back({pairs.size(), i});
    p_unseen.emplace(one.group, 1.0).first->second *= 1 - p_seen_on_frame(landmarks.detectors[one.detector]);
  }
  if (p_unseen.size() < kLeastLandmarks) return 0;
  search.near = around.near;
  search.landmarks_in_px2 = around.in_px2;
  const double frame_km2 = 4 * frame.half_m.prod() * 1e-6;
  for (std::size_t i = 0; i < landmarks.detectors.size(); ++i) {
    const MapDetector& detector = landmarks.detectors[i];
    search.tolerance_px.push_back(landmark_tolerance_m(detector, frame.gsd_m) / frame.gsd_m);
    if (!around.has_class[i]) continue;
    const long false_alarms = std::min(std::lround(detector.false_alarms_per_km2 * frame_km2), kMostFalseAlarms);
    search.sightings.insert(search.sightings.end(), static_cast<std::size_t>(false_alarms), {i, {0, 0}});
  }
  const double search_half_px = frame.search_half_m / frame.gsd_m;
  search.turns_and_scales = turns_and_scales(
      search, {{0, 0}, search_half_px, options.yaw_sigma_deg * kRadPerDeg, options.height_sigma_fraction});
  // More than so many are not told apart: then those that were looked at stand for all.
  const std::size_t looked_at = std::min(p_unseen.size(), kMostGroups);
  const std::size_t alike = looked_at - std::min(looked_at, independent_groups(search, pairs));
  std::vector<double> p_seen;
  for (const auto& [group, p] : p_unseen) p_seen.push_back(1 - p);
  return p_of_fix(search, p_seen, alike, search_half_px, options.max_false_fix_rate);
}

LandmarkProspect prospect_of(const Frame& frame, const MapLandmarks& landmarks, const LandmarksOnGrid& on_grid,
                             const std::vector<bool>& resolved, const MatchOptions& options) {
  LandmarkProspect prospect;
  const NearFrame around = look_around(frame, landmarks, on_grid, resolved);
  std::set<std::size_t> shown_at_all;
  for (int i = 0; i < kHeadings && !around.near.empty(); ++i) {
    const std::vector<std::size_t> shown = shown_by(frame, i * std::numbers::pi / kHeadings, around, landmarks);
    for (const std::size_t one : shown) shown_at_all.insert(around.numbers[one]);
    prospect.p_fix += p_fix_by(shown, frame, around, landmarks, options) / kHeadings;
  }
  prospect.shown.assign(shown_at_all.begin(), shown_at_all.end());
  return prospect;
}

}  // namespace

std::vector<LandmarkProspect> landmark_prospects(const Ground& ground, const MapLandmarks& landmarks,
                                                 const Camera& camera, double search_radius_m) {
  const MatchOptions options;
  const LandmarksOnGrid on_grid(ground.crs, landmarks);
  std::vector<std::vector<bool>> resolved;  // by level, then by detector
  for (const GridLevel& level : ground.levels) {
    resolved.emplace_back();
    for (const MapDetector& detector : landmarks.detectors) {
      resolved.back().push_back(is_resolved(detector, camera, flown_agl_m(level)));
    }
  }
  std::vector<LandmarkProspect> prospects;
  for (const GroundTile& tile : ground.tiles) {
    const Frame frame = frame_over(ground, tile, camera, search_radius_m, options);
    const auto level = static_cast<std::size_t>(&ground.level_of(tile) - ground.levels.data());
    prospects.push_back(prospect_of(frame, landmarks, on_grid, resolved[level], options));
  }
  return prospects;
}

std::vector<std::string> unresolved_classes(const Ground& ground, const MapLandmarks& landmarks, const Camera& camera) {
  std::vector<std::string> names;
  for (const MapDetector& detector : landmarks.detectors) {
    const bool everywhere = std::all_of(ground.levels.begin(), ground.levels.end(), [&](const GridLevel& level) {
      return is_resolved(detector, camera, flown_agl_m(level));
    });
    if (!everywhere) names.push_back(valid_utf8(detector.detector.class_name));
  }
  return names;
}

}  // namespace pilotage
