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

/// A frame about the middle of a tile, and the search around it.
struct Frame {
  Vector2d middle_m{0, 0};
  Vector2d half_m{0, 0};    // of its sides
  double half_width_m = 0;  // of the search
  double gsd_m = 0;

  double radius_m() const { return half_m.norm(); }
  /// Landmarks that a frame of the search may show.
  double reach_m() const { return std::numbers::sqrt2 * half_width_m + 1.2 * radius_m(); }
};

Frame frame_over(const Ground& ground, const GroundTile& tile, const Camera& camera, double search_radius_m,
                 const MatchOptions& options) {
  const GridLevel& level = ground.level_of(tile);
  const Footprint shape = footprint(camera, Attitude{}, level.max_agl_m);
  const double stretch = shape.across_m > 0 && shape.along_m > 0 ? std::sqrt(shape.across_m / shape.along_m) : 1;
  const double half_side_m = std::min(tile.bounds.width_m(), tile.bounds.height_m()) / 2;
  Frame frame;
  frame.middle_m = tile.bounds.center_m();
  frame.half_m = {half_side_m * stretch, half_side_m / stretch};
  frame.half_width_m = search_radius_m + 2 * level.max_agl_m * std::tan(options.attitude_sigma_deg * kRadPerDeg);
  frame.gsd_m = level.gsd_m;
  return frame;
}

/// Landmarks around a frame.
struct NearFrame {
  std::vector<NearLandmark> near;    // from the frame's middle, grouped
  std::vector<std::size_t> numbers;  // indices of MapLandmarks::landmarks
  std::vector<double> in_px2;        // by detector: landmark_densities()
  std::vector<bool> has_class;       // by detector
};

NearFrame look_around(const Frame& frame, const MapLandmarks& landmarks, const LandmarksOnGrid& on_grid) {
  NearFrame around;
  around.has_class.resize(landmarks.detectors.size(), false);
  for (const LandmarksOnGrid::One& one : on_grid.within(frame.middle_m, frame.reach_m())) {
    const MapLandmark& landmark = landmarks.landmarks[one.index];
    const MapDetector& detector = landmarks.detectors[landmark.detector];
    NearLandmark near;
    near.detector = landmark.detector;
    near.map_px = (one.point_m - frame.middle_m) / frame.gsd_m;
    near.half_side_px = looked_at_half_side_m(detector, landmark.length_m) / frame.gsd_m;
    near.found = landmark.found;
    around.near.push_back(near);
    around.numbers.push_back(one.index);
    around.has_class[near.detector] = true;
  }
  if (around.near.empty() || around.near.size() > kMaxNearLandmarks) return {};
  group_landmarks(kLandmarkGroup_m / frame.gsd_m, around.near);
  around.in_px2 = landmark_densities(around.near, landmarks.detectors.size(), frame.reach_m() / frame.gsd_m,
                                     frame.radius_m() / frame.gsd_m);
  return around;
}

/// Which of them a frame that is turned clockwise by so much shows whole, and that were found on the other date.
std::vector<std::size_t> shown_by(const Frame& frame, double heading_rad, const NearFrame& around) {
  const Eigen::Rotation2Dd to_frame(heading_rad);
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < around.near.size(); ++i) {
    const NearLandmark& one = around.near[i];
    const Vector2d off_m = (to_frame * one.map_px).cwiseAbs() * frame.gsd_m;
    const double half_side_m = one.half_side_px * frame.gsd_m;
    if (one.found && ((off_m.array() + half_side_m) <= frame.half_m.array()).all()) shown.push_back(i);
  }
  return shown;
}

/// The chance that so many groups are seen that their evidence, less what the others say by not being seen, is
/// enough. Of all, `alike` say nothing of their own, and these are taken to be among those that are seen.
double p_of_fix(const LandmarkSearch& search, const std::vector<double>& p_seen, std::size_t alike,
                double half_width_px, double max_false_fix_rate) {
  const std::vector<double> p_count = poisson_binomial(p_seen);
  double p_fix = 0;
  double p_so_few = 0;  // so many, or fewer, are seen: what the missing ones say
  for (std::size_t k = 0; k < p_count.size(); ++k) {
    p_so_few += p_count[k];
    const bool all_seen = k + 1 == p_count.size();
    const double against = all_seen ? 0 : -std::log(std::clamp(p_so_few, 1e-30, 1.0));
    const double evidence = landmark_evidence(search, k - std::min(k, alike)) - against;
    if (false_fix_rate(evidence, half_width_px) <= max_false_fix_rate) p_fix += p_count[k];
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
  const double half_width_px = frame.half_width_m / frame.gsd_m;
  search.turns_and_scales = turns_and_scales(
      search, {{0, 0}, half_width_px, options.yaw_sigma_deg * kRadPerDeg, options.height_sigma_fraction});
  const std::size_t alike = p_unseen.size() - std::min(p_unseen.size(), independent_groups(search, pairs));
  std::vector<double> p_seen;
  for (const auto& [group, p] : p_unseen) p_seen.push_back(1 - p);
  return p_of_fix(search, p_seen, alike, half_width_px, options.max_false_fix_rate);
}

LandmarkProspect prospect_of(const Frame& frame, const MapLandmarks& landmarks, const LandmarksOnGrid& on_grid,
                             const MatchOptions& options) {
  LandmarkProspect prospect;
  const NearFrame around = look_around(frame, landmarks, on_grid);
  std::set<std::size_t> shown_at_all;
  for (int i = 0; i < kHeadings && !around.near.empty(); ++i) {
    const std::vector<std::size_t> shown = shown_by(frame, i * std::numbers::pi / kHeadings, around);
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
  std::vector<LandmarkProspect> prospects;
  for (const GroundTile& tile : ground.tiles) {
    prospects.push_back(
        prospect_of(frame_over(ground, tile, camera, search_radius_m, options), landmarks, on_grid, options));
  }
  return prospects;
}

}  // namespace pilotage
