#include "pilotage/match/refined_fix.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

constexpr double kGateSigmas = 4;
constexpr double kMostPairErrorFactor = 2;
/// Of a pair, the least that is believed.
constexpr double kLeastNoise_px = 0.3;
/// Of a pose by features, where landmarks are held against it.
constexpr double kFeaturePoseSigma_m = 1;
/// σ of what landmarks lean away from the nadir, for each metre of their length and the tangent of the angle there: the
/// middle of what lies flat not at all, that of something half as high as it is long by a quarter. Modelled, not
/// measured.
constexpr double kLeanOfLength = 0.1;

/// The ground's height at a place over that straight below the aircraft; 0 where no heights are known.
double rise_m(const GroundHeights& ground, const Eigen::Vector2d& place_px, const Eigen::Vector2d& nadir_px) {
  return ground.known() ? ground.height_m(place_px) - ground.height_m(nadir_px) : 0;
}

/// The frame's rays and the map's points of the pairs.
std::vector<GroundPair> ground_pairs(const FrameOnGrid& rectified, const PivotedFrame& frame, const LocalMap& map,
                                     const MatchPrior& prior, const std::vector<GuidedPair>& pairs,
                                     const Eigen::Vector2d& nadir_px) {
  const double below_m = map.relief.ground.height_m(nadir_px);
  std::vector<GroundPair> result;
  for (const GuidedPair& pair : pairs) {
    const Eigen::Vector2d ground = rectified.frame.ground_from_pixel(pair.from_pivot_px + frame.pivot_px);
    GroundPair on_ground;
    on_ground.ray_m = {ground.x(), ground.y(), -prior.height_agl_m};
    on_ground.map_m = rectified.m_from_px(pair.map_px);
    const auto height_m = static_cast<double>(map.ground_height_m[pair.map_feature]);
    on_ground.rise_m = std::isfinite(height_m) && map.relief.ground.known()
                           ? height_m - below_m
                           : rise_m(map.relief.ground, pair.map_px, nadir_px);
    result.push_back(on_ground);
  }
  return result;
}

/// The rise of the ground that a ray meets: the height where it was met last, a few times over.
double rise_of_ray(const FrameOnGrid& rectified, const GroundHeights& ground, const PoseCorrection& pose,
                   const Eigen::Vector3d& ray_m) {
  constexpr int kRounds = 4;
  double rise = 0;
  for (int i = 0; i < kRounds && ground.known(); ++i) {
    const Eigen::Vector2d met_px = rectified.px_from_m(pose.ground_from_ray(ray_m, rise));
    rise = rise_m(ground, met_px, rectified.px_from_m(pose.position_m));
  }
  return rise;
}

/// PosePrior::pair_error_factor: all support over what chance does not give. Where features alone make the fix, its
/// error is that of the residuals (docs/methods/match.md).
double pair_error_factor(const RankedPlace& place) {
  if (!place.chips_decide) return 1;
  const double support = place.match.evidence();
  const double beyond_chance = support - place.chance_support;
  return kMostPairErrorFactor * beyond_chance > support ? support / beyond_chance : kMostPairErrorFactor;
}

/// The tile of the feature nearest to the principal point's place.
std::optional<std::int64_t> tile_at(const LocalMap& map, const Eigen::Vector2d& center_px) {
  std::optional<std::int64_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < map.features.size(); ++i) {
    const Feature& feature = map.features.features[i];
    const double distance =
        (Eigen::Vector2d(static_cast<double>(feature.x_px), static_cast<double>(feature.y_px)) - center_px).norm();
    if (distance < least) {
      least = distance;
      nearest = map.tile_ids[i];
    }
  }
  return nearest;
}

/// How sure the prior pose is, on the grid.
PosePrior pose_prior(const FrameOnGrid& rectified, const LocalMap& map, const MatchPrior& prior,
                     const MatchOptions& options) {
  PosePrior sigmas;
  const Eigen::Matrix2d grid_from_enu = rectified.enu_from_grid_m().inverse();
  sigmas.position_covariance_m2 = grid_from_enu * prior.covariance_en_m2 * grid_from_enu.transpose();
  sigmas.tilt_sigma_rad = options.attitude_sigma_deg * kRadPerDeg;
  sigmas.yaw_sigma_rad = options.yaw_sigma_deg * kRadPerDeg;
  sigmas.log_height_sigma = options.height_sigma_fraction;
  sigmas.height_sigma_m = map.relief.height_sigma_m;
  return sigmas;
}

/// The pose that pairs give at a placement, as a fix. Nothing when it does not converge.
std::optional<RefinedFix> refined_by(const std::vector<GroundPair>& on_ground, const PosePrior& sigmas,
                                     const FrameOnGrid& rectified, const PivotedFrame& frame, const LocalMap& map,
                                     const MatchPrior& prior, const Placement& placement) {
  const Eigen::Matrix2d enu_from_grid = rectified.enu_from_grid_m();
  const Eigen::Vector2d prior_m = rectified.m_from_px(rectified.prior_px - map.reference_px);
  const Eigen::Vector2d start_m = rectified.m_from_px(placement.map_from_frame(frame.nadir_px - frame.pivot_px));
  RefinedFix refined;
  refined.pose = refine_pose(on_ground, sigmas, prior_m, start_m, kLeastNoise_px * rectified.gsd_m);
  if (!refined.pose.converged) return std::nullopt;

  const PoseCorrection& pose = refined.pose;
  const auto geodetic = [&](const Eigen::Vector2d& m) {
    return rectified.grid.geodetic_from_px(map.reference_px + rectified.px_from_m(m));
  };
  Fix& fix = refined.fix;
  fix.position = geodetic(pose.position_m);
  fix.covariance_en_m2 = enu_from_grid * pose.covariance.topLeftCorner<2, 2>() * enu_from_grid.transpose();
  const Eigen::Vector3d pivot_ray(rectified.pivot_m.x(), rectified.pivot_m.y(), -prior.height_agl_m);
  const double center_rise_m = rise_of_ray(rectified, map.relief.ground, pose, pivot_ray);
  fix.center = geodetic(pose.ground_from_ray(pivot_ray, center_rise_m));
  const Eigen::Matrix<double, 2, 6> jacobian = pose.ground_jacobian(pivot_ray, center_rise_m);
  fix.center_covariance_en_m2 =
      enu_from_grid * jacobian * pose.covariance * jacobian.transpose() * enu_from_grid.transpose();
  fix.yaw_deg = std::remainder(prior.attitude.yaw_deg - pose.turn_rad / kRadPerDeg, 360.0);
  if (fix.yaw_deg < 0) fix.yaw_deg += 360;
  // A rotation vector about right and up of the grid; nose and wing are turned from it by the heading on the grid.
  const double heading_rad = (fix.yaw_deg - rectified.grid.convergence_deg()) * kRadPerDeg;
  const Eigen::Vector2d nose(std::sin(heading_rad), std::cos(heading_rad));
  const Eigen::Vector2d wing(std::cos(heading_rad), -std::sin(heading_rad));
  fix.roll_deg = prior.attitude.roll_deg + pose.tilt_rad.dot(nose) / kRadPerDeg;
  fix.pitch_deg = prior.attitude.pitch_deg + pose.tilt_rad.dot(wing) / kRadPerDeg;
  fix.yaw_sigma_deg = std::sqrt(pose.covariance(4, 4)) / kRadPerDeg;
  fix.scale = std::exp(pose.log_height);
  fix.height_agl_m = prior.height_agl_m * fix.scale;
  fix.height_sigma_m = std::sqrt(pose.covariance(5, 5)) * fix.height_agl_m;
  fix.tile_id = tile_at(map, placement.center_px);
  return refined;
}

/// A sighting and its landmark, the heights against that under the aircraft at the placement.
GroundPair ground_pair(const FrameOnGrid& rectified, const PivotedFrame& frame, const LocalMap& map,
                       const MatchPrior& prior, const LandmarkSearch& landmarks, const LandmarkPair& pair,
                       const Placement& placement) {
  const Eigen::Vector2d nadir_px = placement.map_from_frame(frame.nadir_px - frame.pivot_px);
  const NearLandmark& landmark = landmarks.near[pair.near];
  const Eigen::Vector2d from_pivot_px = landmarks.sightings[pair.sighting].from_pivot_px;
  const Eigen::Vector2d ground = rectified.frame.ground_from_pixel(from_pivot_px + frame.pivot_px);
  GroundPair one;
  one.ray_m = {ground.x(), ground.y(), -prior.height_agl_m};
  one.map_m = rectified.m_from_px(landmark.map_px);
  one.rise_m = std::isfinite(landmark.height_m) && map.relief.ground.known()
                   ? landmark.height_m - map.relief.ground.height_m(nadir_px)
                   : rise_m(map.relief.ground, landmark.map_px, nadir_px);
  return one;
}

/// independent_groups() of the pairs that a pose puts within three of their own σ and `pose_sigma_m`.
std::size_t agreeing_groups(const FrameOnGrid& rectified, const PivotedFrame& frame, const LocalMap& map,
                            const MatchPrior& prior, const LandmarkSearch& landmarks, const RankedPlace& place,
                            const PoseCorrection& pose, double pose_sigma_m) {
  std::vector<LandmarkPair> agreeing;
  for (const LandmarkPair& pair : place.landmarks.pairs) {
    const GroundPair one = ground_pair(rectified, frame, map, prior, landmarks, pair, place.match.placement);
    const double sigma_m = landmarks.sigma_m[landmarks.sightings[pair.sighting].detector];
    const double off_m = (pose.ground_from_ray(one.ray_m, one.rise_m) - one.map_m).norm();
    if (off_m <= 3 * std::hypot(sigma_m, pose_sigma_m)) agreeing.push_back(pair);
  }
  return independent_groups(landmarks, agreeing);
}

}  // namespace

std::optional<RefinedFix> refine_fix(const FrameOnGrid& rectified, const PivotedFrame& frame, const LocalMap& map,
                                     const MatchPrior& prior, const MatchOptions& options, const RankedPlace& place) {
  const Placement& placement = place.match.placement;
  const auto pairs = supporting_pairs(frame, map, placement);
  PosePrior sigmas = pose_prior(rectified, map, prior, options);
  sigmas.lean_sigma_m = kLeanSigma_px * rectified.gsd_m;
  sigmas.lean_length_m = kLeanLength_px * rectified.gsd_m;
  sigmas.pair_error_factor = pair_error_factor(place);
  const Eigen::Vector2d nadir_px = placement.map_from_frame(frame.nadir_px - frame.pivot_px);
  const auto on_ground = ground_pairs(rectified, frame, map, prior, pairs, nadir_px);
  return refined_by(on_ground, sigmas, rectified, frame, map, prior, placement);
}

std::optional<RefinedFix> refine_fix_by_landmarks(const FrameOnGrid& rectified, const PivotedFrame& frame,
                                                  const LocalMap& map, const MatchPrior& prior,
                                                  const MatchOptions& options, const LandmarkSearch& landmarks,
                                                  const RankedPlace& place) {
  PosePrior sigmas = pose_prior(rectified, map, prior, options);
  std::vector<GroundPair> on_ground;
  double variance_m2 = 0;
  double lean_m2 = 0;
  for (const LandmarkPair& pair : place.landmarks.pairs) {
    on_ground.push_back(ground_pair(rectified, frame, map, prior, landmarks, pair, place.match.placement));
    const double sigma_m = landmarks.sigma_m[landmarks.sightings[pair.sighting].detector];
    variance_m2 = std::max(variance_m2, sigma_m * sigma_m);
    lean_m2 += std::pow(kLeanOfLength * landmarks.near[pair.near].length_m * on_ground.back().ray_m.head<2>().norm() /
                            prior.height_agl_m,
                        2);
  }
  sigmas.pair_sigma_m = std::hypot(std::sqrt(variance_m2), kLeastNoise_px * rectified.gsd_m);
  sigmas.lean_sigma_m = std::sqrt(lean_m2 / std::max(1.0, static_cast<double>(on_ground.size())));
  sigmas.lean_length_m = kHeightErrorLength_m;
  auto refined = refined_by(on_ground, sigmas, rectified, frame, map, prior, place.match.placement);
  if (!refined) return std::nullopt;
  refined->landmark_groups = agreeing_groups(rectified, frame, map, prior, landmarks, place, refined->pose,
                                             std::hypot(kLeastNoise_px * rectified.gsd_m, sigmas.lean_sigma_m));
  return refined;
}

std::optional<RefinedFix> refine_fix_beside_landmarks(const FrameOnGrid& rectified, const PivotedFrame& frame,
                                                      const LocalMap& map, const MatchPrior& prior,
                                                      const MatchOptions& options, const LandmarkSearch& landmarks,
                                                      const RankedPlace& place) {
  auto refined = refine_fix(rectified, frame, map, prior, options, place);
  if (!refined) return std::nullopt;
  refined->landmark_groups = agreeing_groups(rectified, frame, map, prior, landmarks, place, refined->pose,
                                             std::max(kFeaturePoseSigma_m, rectified.gsd_m));
  return refined;
}

void add_map_error(Fix& fix, double map_sigma_m) {
  fix.map_sigma_m = map_sigma_m;
  fix.covariance_en_m2 += isotropic_covariance_m2(map_sigma_m);
  fix.center_covariance_en_m2 += isotropic_covariance_m2(map_sigma_m);
}

bool contradicts_told_height(const Fix& fix, const MatchOptions& options) {
  return std::abs(std::log(fix.scale)) > kGateSigmas * options.height_sigma_fraction;
}

bool is_outside_gate(const Fix& fix, const MatchPrior& prior, const MatchOptions& options) {
  const Eigen::Vector2d off_m = LocalFrame(prior.position).enu_from_geodetic(fix.position).head<2>();
  const double by_tilt_m = 2 * prior.height_agl_m * std::tan(options.attitude_sigma_deg * kRadPerDeg);
  const Eigen::Matrix2d gate = prior.covariance_en_m2 + isotropic_covariance_m2(by_tilt_m / options.search_sigmas);
  if (off_m.cwiseAbs().maxCoeff() > search_half_width_m(prior, options)) return true;
  // Twice: the ellipse about the square of half side search_sigmas, for priors that are told as a square are common.
  if (!(mahalanobis_squared(off_m, gate) <= 2 * options.search_sigmas * options.search_sigmas)) return true;
  const double tilt_deg = std::hypot(fix.roll_deg - prior.attitude.roll_deg, fix.pitch_deg - prior.attitude.pitch_deg);
  if (tilt_deg > kGateSigmas * options.attitude_sigma_deg) return true;
  const double turn_deg = std::remainder(fix.yaw_deg - prior.attitude.yaw_deg, 360.0);
  if (std::abs(turn_deg) > kGateSigmas * options.yaw_sigma_deg) return true;
  return contradicts_told_height(fix, options);
}

}  // namespace pilotage
