#include "pilotage/match/match.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/camera/projection.h"
#include "pilotage/match/chip_mosaic.h"
#include "pilotage/match/chip_search.h"
#include "pilotage/match/displacement_voting.h"
#include "pilotage/match/frame_grid.h"
#include "pilotage/match/guided_matching.h"
#include "pilotage/match/local_map.h"
#include "pilotage/match/match_confidence.h"
#include "pilotage/match/pose_refinement.h"

namespace pilotage {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr int kMaxRectifiedSidePx = 768;  // about 0.5 km at 0.6 m/px: more adds time, not certainty
constexpr double kMaxSearchBins = 1e9;    // some ten seconds
constexpr double kMaxHalfWidthPx = 4096;  // of the search square: its histogram takes 64 MiB
constexpr std::size_t kCandidates = 30;   // of 1,000 real frames, 95 % had the true place among the first 30
constexpr std::size_t kRankedPlaces = 8;  // of these, the best by descriptors, chips are looked at
constexpr int kChipReachPx = 2;
constexpr int kMinFeatures = 20;
constexpr double kMinRivalDistance_m = 6;
constexpr double kGateSigmas = 4;
constexpr double kMinLead = 3;  // of the best place over its rival, in natural logarithms

/// Everything that is known once the frame lies on the map's grid.
struct Scene {
  const MapLevel* level = nullptr;
  LocalGrid grid;
  RectifiedFrame frame;
  Eigen::Vector2d pivot_m{0, 0};   ///< Ground under the principal point, from the nadir, right and up.
  Eigen::Vector2d prior_px{0, 0};  ///< Of the aircraft, in pixels of the level.
  double half_width_px = 0;
  double gsd_m = 1;

  /// From metres right and up to pixels right and down, and back; lengths only.
  Eigen::Vector2d px_from_m(const Eigen::Vector2d& m) const { return {m.x() / gsd_m, -m.y() / gsd_m}; }
  Eigen::Vector2d m_from_px(const Eigen::Vector2d& px) const { return {px.x() * gsd_m, -px.y() * gsd_m}; }
  Eigen::Matrix2d enu_from_grid_m() const {
    Eigen::Matrix2d px_per_m;
    px_per_m << 1 / gsd_m, 0, 0, -1 / gsd_m;
    return grid.enu_from_px * px_per_m;
  }
};

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

bool prior_is_good(const MatchPrior& prior) {
  return std::isfinite(prior.position.lon_deg) && is_inside(prior.position.lon_deg, -360, 360) &&
         is_inside(prior.position.lat_deg, -90, 90) && is_inside(prior.sigma_m, 1e-3, 1e5) &&
         is_inside(prior.height_agl_m, 1e-3, 1e5) && std::isfinite(prior.attitude.yaw_deg) &&
         std::isfinite(prior.attitude.pitch_deg) && std::isfinite(prior.attitude.roll_deg);
}

/// Half side of the searched square: the prior's window, and what the tilt's error moves the principal point by.
double search_half_width_m(const MatchPrior& prior, const MatchOptions& options) {
  return options.search_sigmas * prior.sigma_m +
         2 * prior.height_agl_m * std::tan(options.attitude_sigma_deg * kRadPerDeg);
}

MatchStatus status_of(RectifyStatus status) {
  switch (status) {
    case RectifyStatus::kBadCamera:
      return MatchStatus::kBadCamera;
    case RectifyStatus::kBadAttitude:
    case RectifyStatus::kBadHeight:
      return MatchStatus::kBadPrior;
    case RectifyStatus::kNoGround:
      return MatchStatus::kNoGround;
    default:
      return MatchStatus::kBadFrame;
  }
}

std::optional<FeatureOptions> feature_options(const MapReader& map) {
  FeatureOptions options;
  if (const auto bits = map.info().find("features.descriptor_bits")) options.descriptor_bits = std::atoi(bits->c_str());
  options.oriented = map.info().find("features.oriented") == "true";
  if (options.descriptor_bits != 128 && options.descriptor_bits != 256 && options.descriptor_bits != 512) {
    return std::nullopt;
  }
  return options;
}

/// Lays the frame on the grid of the level that serves its height. A status other than kFix when that cannot be.
MatchStatus make_scene_of(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                          const MatchOptions& options, Scene& scene) {
  scene.level = level_for_height(map, prior.height_agl_m);
  if (scene.level == nullptr) return MatchStatus::kNoMap;
  const double half_width_m = search_half_width_m(prior, options);
  const double reach_m = std::min(half_width_m * std::numbers::sqrt2 + scene.level->max_tile_radius_m, 1e5);
  const auto grid = local_grid(map, *scene.level, prior.position, reach_m);
  if (!grid) return MatchStatus::kNoMap;
  scene.grid = *grid;
  scene.gsd_m = grid->gsd_m();
  scene.half_width_px = half_width_m / scene.gsd_m;
  if (scene.half_width_px > kMaxHalfWidthPx) return MatchStatus::kBadPrior;
  scene.prior_px = grid->px_from_geodetic(prior.position);

  Attitude on_grid = prior.attitude;
  on_grid.yaw_deg -= grid->convergence_deg();
  RectifyOptions rectify;
  rectify.gsd_m = scene.gsd_m;
  rectify.max_size_px = kMaxRectifiedSidePx;
  scene.frame = ortho_rectify(frame, camera, on_grid, prior.height_agl_m, rectify);
  if (scene.frame.status != RectifyStatus::kOk) return status_of(scene.frame.status);
  const auto view = make_view(camera, on_grid, prior.height_agl_m);
  const auto principal = view ? ground_from_pixel(*view, {camera.cx_px, camera.cy_px}) : std::nullopt;
  const cv::Size size = scene.frame.gray.size();
  scene.pivot_m = principal.value_or(scene.frame.ground_from_pixel({size.width / 2.0, size.height / 2.0}));
  return MatchStatus::kFix;
}

PivotedFrame describe(const Scene& scene, const FeatureOptions& options) {
  PivotedFrame frame;
  frame.grid = describe_frame_grid(scene.frame, options);
  frame.pivot_px = scene.frame.pixel_from_ground(scene.pivot_m);
  for (const Feature& point : frame.grid.points.features) {
    const Eigen::Vector2d place(static_cast<double>(point.x_px), static_cast<double>(point.y_px));
    frame.radius_px = std::max(frame.radius_px, (place - frame.pivot_px).norm());
  }
  return frame;
}

SearchSpace search_space(const Scene& scene, const LocalMap& map, const MatchOptions& options, bool oriented) {
  SearchSpace space;
  space.center_px = scene.prior_px + scene.px_from_m(scene.pivot_m) - map.reference_px;
  space.half_width_px = scene.half_width_px;
  space.yaw_sigma_rad = options.yaw_sigma_deg * kRadPerDeg;
  space.scale_sigma = options.height_sigma_fraction;
  space.oriented = oriented;
  return space;
}

/// The frame on the map's chips.
struct ChipComparison {
  RectifiedFrame frame;
  ChipMosaic mosaic;
  ChipMatch best;
  Eigen::Vector2d pivot_from_nadir_px{0, 0};  ///< In pixels of the level.
  Eigen::Vector2d reference_px{0, 0};         ///< LocalMap::reference_px.

  /// A place of the nadir as a placement of the pivot, and back.
  Placement placement(const ChipMatch& match) const {
    Placement turned{{0, 0}, match.yaw_deg * kRadPerDeg, match.scale};
    turned.center_px = match.nadir_px - reference_px + turned.map_from_frame(pivot_from_nadir_px);
    return turned;
  }
  ChipMatch match_at(const Placement& placement) const {
    ChipMatch match = best;
    match.found = true;
    match.yaw_deg = placement.yaw_rad / kRadPerDeg;
    match.scale = placement.scale;
    match.nadir_px = reference_px + placement.map_from_frame(-pivot_from_nadir_px);
    return match;
  }
};

/// Nothing when the map has no chips here, or when the heading is unknown: chips are compared upright.
std::optional<ChipComparison> compare_chips(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                            MapReader& map, const MatchOptions& options, const Scene& scene,
                                            const PivotedFrame& described, const LocalMap& local) {
  if (!options.chips || !map.has_chips() || options.yaw_sigma_deg * kRadPerDeg > kUnknownYawRad) return std::nullopt;
  ChipComparison chips;
  chips.reference_px = local.reference_px;
  chips.pivot_from_nadir_px = scene.px_from_m(scene.pivot_m);
  const double reach_px = scene.half_width_px + chips.pivot_from_nadir_px.norm() + 1.2 * described.radius_px;
  chips.mosaic = read_chip_mosaic(map, scene.level->matrix.level, scene.prior_px, reach_px);
  if (chips.mosaic.gray.empty()) return std::nullopt;
  Attitude on_grid = prior.attitude;
  on_grid.yaw_deg -= scene.grid.convergence_deg();
  RectifyOptions rectify;
  rectify.gsd_m = scene.gsd_m * chips.mosaic.factor;
  rectify.max_size_px = kMaxRectifiedSidePx;
  chips.frame = ortho_rectify(frame, camera, on_grid, prior.height_agl_m, rectify);
  if (chips.frame.status != RectifyStatus::kOk) return std::nullopt;
  const auto hypotheses = chip_hypotheses(1.5 * options.yaw_sigma_deg, 3, 1.5 * options.height_sigma_fraction, 3);
  chips.best = search_chips(chips.frame, chips.mosaic, scene.prior_px, scene.half_width_px, hypotheses);
  return chips;
}

/// A place and what speaks for it.
struct RankedPlace {
  GuidedMatch match;
  double ncc = 0;
  int compared_px = 0;  ///< Pixels of chips behind it.
  double evidence = 0;
};

/// The best place, and the evidence of the best elsewhere.
struct RankedPlaces {
  RankedPlace best;
  double rival_evidence = 0;
  double rival_ncc = 0;
};

RankedPlace rank_place(const GuidedMatch& match, const std::optional<ChipComparison>& chips) {
  RankedPlace place{match, 0, 0, 0};
  if (chips) {
    const ChipMatch there =
        confirm_chip_match(chips->frame, chips->mosaic, chips->match_at(match.placement), kChipReachPx);
    place.ncc = there.found ? there.ncc : 0;
    place.compared_px = there.found ? there.pixels : 0;
  }
  place.evidence =
      place_evidence({match.evidence(), match.expected, place.ncc, static_cast<double>(place.compared_px)});
  return place;
}

std::optional<RankedPlaces> rank_places(const PivotedFrame& frame, const LocalMap& map, const SearchSpace& space,
                                        const std::optional<ChipComparison>& chips, double gsd_m) {
  std::vector<GuidedMatch> matches;
  for (const Candidate& candidate : vote_for_displacements(frame, map, space, kCandidates)) {
    matches.push_back(match_guided(frame, map, space, candidate));
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const GuidedMatch& a, const GuidedMatch& b) { return a.evidence() > b.evidence(); });
  if (matches.size() > kRankedPlaces) matches.resize(kRankedPlaces);
  if (chips && chips->best.found) {
    matches.push_back(match_guided(frame, map, space, {chips->placement(chips->best), 0}));
  }
  if (matches.empty()) return std::nullopt;
  std::vector<RankedPlace> ranked;
  for (const GuidedMatch& match : matches) ranked.push_back(rank_place(match, chips));
  RankedPlaces places;
  places.best = *std::max_element(ranked.begin(), ranked.end(),
                                  [](const RankedPlace& a, const RankedPlace& b) { return a.evidence < b.evidence; });
  const double min_distance_px = std::max(kMinRivalDistance_m / gsd_m, kPeakSeparationPx);
  for (const RankedPlace& place : ranked) {
    const double distance_px = (place.match.placement.center_px - places.best.match.placement.center_px).norm();
    if (distance_px <= min_distance_px) continue;
    places.rival_evidence = std::max(places.rival_evidence, place.evidence);
    places.rival_ncc = std::max(places.rival_ncc, place.ncc);
  }
  return places;
}

/// The frame's rays and the map's points of the pairs, turned by the placement's yaw where the prior has none.
std::vector<GroundPair> ground_pairs(const Scene& scene, const PivotedFrame& frame, const LocalMap& map,
                                     const MatchPrior& prior, const std::vector<GuidedPair>& pairs, double turn_rad) {
  const double cosine = std::cos(turn_rad);
  const double sine = std::sin(turn_rad);
  double heights_m = 0;
  int known = 0;
  for (const GuidedPair& pair : pairs) {
    const auto height_m = static_cast<double>(map.ground_height_m[pair.map_feature]);
    if (std::isfinite(height_m)) heights_m += height_m, ++known;
  }
  std::vector<GroundPair> result;
  for (const GuidedPair& pair : pairs) {
    const Eigen::Vector2d ground = scene.frame.ground_from_pixel(pair.from_pivot_px + frame.pivot_px);
    GroundPair on_ground;
    // Clockwise, with y up.
    on_ground.ray_m = {cosine * ground.x() + sine * ground.y(), -sine * ground.x() + cosine * ground.y(),
                       -prior.height_agl_m};
    on_ground.map_m = scene.m_from_px(pair.map_px);
    const auto height_m = static_cast<double>(map.ground_height_m[pair.map_feature]);
    if (std::isfinite(height_m)) on_ground.rise_m = height_m - heights_m / known;
    result.push_back(on_ground);
  }
  return result;
}

/// The refined pose at a place, as a fix.
struct RefinedFix {
  Fix fix;
  PoseCorrection pose;
};

std::optional<RefinedFix> refine(const Scene& scene, const PivotedFrame& frame, const LocalMap& map,
                                 const MatchPrior& prior, const MatchOptions& options, const GuidedMatch& place) {
  const bool yaw_unknown = options.yaw_sigma_deg * kRadPerDeg > kUnknownYawRad;
  const double base_turn_rad = yaw_unknown ? place.placement.yaw_rad : 0;
  const auto pairs = supporting_pairs(frame, map, place.placement);
  const auto on_ground = ground_pairs(scene, frame, map, prior, pairs, base_turn_rad);
  PosePrior sigmas;
  sigmas.position_sigma_m = prior.sigma_m;
  sigmas.tilt_sigma_rad = options.attitude_sigma_deg * kRadPerDeg;
  sigmas.yaw_sigma_rad = options.yaw_sigma_deg * kRadPerDeg;
  sigmas.log_height_sigma = options.height_sigma_fraction;
  const Eigen::Vector2d prior_m = scene.m_from_px(scene.prior_px - map.reference_px);
  const Eigen::Vector2d nadir_from_pivot = frame.grid.points.size() > 0
                                               ? Eigen::Vector2d(scene.frame.pixel_from_ground({0, 0}) - frame.pivot_px)
                                               : Eigen::Vector2d::Zero();
  const Eigen::Vector2d start_m = scene.m_from_px(place.placement.map_from_frame(nadir_from_pivot));
  RefinedFix refined;
  refined.pose = refine_pose(on_ground, sigmas, prior_m, start_m, 0.3 * scene.gsd_m);
  if (!refined.pose.converged) return std::nullopt;

  const PoseCorrection& pose = refined.pose;
  const Eigen::Matrix2d enu_from_grid = scene.enu_from_grid_m();
  const Eigen::Matrix2d map_noise = Eigen::Matrix2d::Identity() * options.map_sigma_m * options.map_sigma_m;
  const auto geodetic = [&](const Eigen::Vector2d& m) {
    return scene.grid.geodetic_from_px(map.reference_px + scene.px_from_m(m));
  };
  Fix& fix = refined.fix;
  fix.position = geodetic(pose.position_m);
  fix.covariance_en_m2 = enu_from_grid * pose.covariance.topLeftCorner<2, 2>() * enu_from_grid.transpose() + map_noise;
  const Eigen::Rotation2Dd base_turn(-base_turn_rad);
  const Eigen::Vector2d pivot_m = base_turn * scene.pivot_m;
  const Eigen::Vector3d pivot_ray(pivot_m.x(), pivot_m.y(), -prior.height_agl_m);
  fix.center = geodetic(pose.ground_from_ray(pivot_ray));
  const Eigen::Matrix<double, 2, 6> jacobian = pose.ground_jacobian(pivot_ray);
  fix.center_covariance_en_m2 =
      enu_from_grid * jacobian * pose.covariance * jacobian.transpose() * enu_from_grid.transpose() + map_noise;
  fix.yaw_deg = std::remainder(prior.attitude.yaw_deg + (base_turn_rad - pose.turn_rad) / kRadPerDeg, 360.0);
  if (fix.yaw_deg < 0) fix.yaw_deg += 360;
  // A rotation vector about right and up of the grid; nose and wing are turned from it by the heading on the grid.
  const double heading_rad = (fix.yaw_deg - scene.grid.convergence_deg()) * kRadPerDeg;
  const Eigen::Vector2d nose(std::sin(heading_rad), std::cos(heading_rad));
  const Eigen::Vector2d wing(std::cos(heading_rad), -std::sin(heading_rad));
  fix.roll_deg = prior.attitude.roll_deg + pose.tilt_rad.dot(nose) / kRadPerDeg;
  fix.pitch_deg = prior.attitude.pitch_deg + pose.tilt_rad.dot(wing) / kRadPerDeg;
  fix.yaw_sigma_deg = std::sqrt(pose.covariance(4, 4)) / kRadPerDeg;
  fix.scale = std::exp(pose.log_height);
  fix.height_agl_m = prior.height_agl_m * fix.scale;
  fix.height_sigma_m = std::sqrt(pose.covariance(5, 5)) * fix.height_agl_m;
  return refined;
}

/// The tile of the feature nearest to the principal point's place.
std::int64_t tile_at(const LocalMap& map, const Eigen::Vector2d& center_px) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < map.features.size(); ++i) {
    const Feature& feature = map.features.features[i];
    const double distance =
        (Eigen::Vector2d(static_cast<double>(feature.x_px), static_cast<double>(feature.y_px)) - center_px).norm();
    if (distance < least) {
      least = distance;
      nearest = i;
    }
  }
  return map.tile_ids[nearest];
}

bool is_outside_gate(const Scene& scene, const LocalMap& map, const MatchPrior& prior, const MatchOptions& options,
                     const PoseCorrection& pose) {
  const Eigen::Vector2d off_m = pose.position_m - scene.m_from_px(scene.prior_px - map.reference_px);
  if (off_m.cwiseAbs().maxCoeff() > search_half_width_m(prior, options)) return true;
  if (pose.tilt_rad.norm() > kGateSigmas * options.attitude_sigma_deg * kRadPerDeg) return true;
  if (options.yaw_sigma_deg * kRadPerDeg <= kUnknownYawRad &&
      std::abs(pose.turn_rad) > kGateSigmas * options.yaw_sigma_deg * kRadPerDeg) {
    return true;
  }
  return std::abs(pose.log_height) > kGateSigmas * options.height_sigma_fraction;
}

MatchResult match_or_throw(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                           const MatchOptions& options) {
  MatchResult result;
  Scene scene;
  result.status = make_scene_of(frame, prior, camera, map, options, scene);
  if (scene.level != nullptr) result.stats.level = scene.level->matrix.level;
  result.stats.gsd_m = scene.gsd_m;
  if (result.status != MatchStatus::kFix) return result;
  const auto features = feature_options(map);
  if (!features) return {MatchStatus::kMapUnreadable, {}, {}, result.stats};

  const PivotedFrame described = describe(scene, *features);
  const Eigen::Vector2d center_px = scene.prior_px + scene.px_from_m(scene.pivot_m);
  const LocalMap local =
      read_local_map(map, *scene.level, scene.grid, center_px, scene.half_width_px + described.radius_px);
  result.stats.frame_features = static_cast<int>(described.grid.points.size());
  result.stats.map_features = static_cast<int>(local.features.size());
  if (local.features.size() == 0) return {MatchStatus::kNoMap, {}, {}, result.stats};
  if (result.stats.frame_features < kMinFeatures || result.stats.map_features < kMinFeatures) {
    return {MatchStatus::kTooFewFeatures, {}, {}, result.stats};
  }

  const SearchSpace space = search_space(scene, local, options, features->oriented);
  if (search_bins(described, space) > kMaxSearchBins) return {MatchStatus::kBadPrior, {}, {}, result.stats};
  const auto chips = compare_chips(frame, prior, camera, map, options, scene, described, local);
  const auto places = rank_places(described, local, space, chips, scene.gsd_m);
  if (!places) return {MatchStatus::kInconsistent, {}, {}, result.stats};
  const RankedPlace& best = places->best;
  result.stats.support = best.match.evidence();
  result.stats.expected_features = best.match.expected;
  result.stats.vote_peak = best.evidence;
  result.stats.vote_rival = places->rival_evidence;
  result.stats.ncc = best.ncc;
  result.stats.ncc_rival = places->rival_ncc;
  result.stats.chip_pixels = best.compared_px;
  result.stats.confidence = 1 - false_fix_rate(best.evidence);
  auto refined = refine(scene, described, local, prior, options, best.match);
  if (!refined) return {MatchStatus::kInconsistent, {}, {}, result.stats};
  refined->fix.tile_id = tile_at(local, best.match.placement.center_px);
  result.stats.inliers = refined->pose.inliers;
  result.stats.residual_m = refined->pose.residual_m;
  result.candidate = refined->fix;
  if (1 - result.stats.confidence > options.max_false_fix_rate) {
    result.status = MatchStatus::kInconsistent;
  } else if (places->best.evidence - places->rival_evidence < kMinLead) {
    result.status = MatchStatus::kAmbiguous;
  } else if (is_outside_gate(scene, local, prior, options, refined->pose)) {
    result.status = MatchStatus::kOutsideGate;
  } else {
    result.fix = refined->fix;
  }
  return result;
}

}  // namespace

MatchResult match(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera, MapReader& map,
                  const MatchOptions& options) {
  if (!options_are_good(options)) return {MatchStatus::kBadOptions, {}, {}, {}};
  if (!prior_is_good(prior)) return {MatchStatus::kBadPrior, {}, {}, {}};
  try {
    return match_or_throw(frame, prior, camera, map, options);
  } catch (const DataError&) {
    return {MatchStatus::kMapUnreadable, {}, {}, {}};
  } catch (const UsageError&) {
    return {MatchStatus::kBadPrior, {}, {}, {}};
  }
}

}  // namespace pilotage
