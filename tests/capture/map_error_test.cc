#include "pilotage/capture/map_error.h"

#include <array>
#include <cmath>
#include <optional>

#include "testing/pinhole_camera.h"
#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "pilotage/base/angle.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/camera/lens.h"
#include "pilotage/capture/reference_ties.h"

namespace pilotage {
namespace {

using pilotage::testing::pinhole_camera;

/// How far the measured values of a drawn block lie from the truth: standard deviations.
struct BlockNoise {
  double position_m = 2;
  double position_bias_m = 4;
  double height_m = 3;
  double tilt_deg = 2;
  double heading_deg = 4;
  double focal_length = 0.01;
  bool with_attitude = true;
  bool with_elevation = false;
  double slope = 0;  ///< Of the ground, upwards to the north.
  int lines = 4;
  double reference_m = 0;  ///< Of the map that the block is tied to, if not 0; ties are good to
  double tie_m = 0.5;
  double bend_m = 0;  ///< By how much the other map is bent, as a wave of 300 m.
};

struct DrawnBlock {
  std::vector<FramePose> truth;
  Camera camera;  ///< The true one.
  Block block;    ///< As measured.
};

constexpr double kHeight_m = 100;
constexpr double kSmallHill_m = 4;

double true_ground_m(const Eigen::Vector2d& en_m, double slope) {
  return kSmallHill_m * std::exp(-en_m.squaredNorm() / (2 * 60.0 * 60.0)) + slope * en_m.y();
}

Eigen::Matrix3d turned_by(const Eigen::Vector3d& angles_rad) {
  const double angle_rad = angles_rad.norm();
  if (angle_rad == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle_rad, angles_rad / angle_rad).toRotationMatrix();
}

Eigen::Vector3d normal3(Random& random, double sigma) {
  const double x = sigma * random.normal();
  const double y = sigma * random.normal();
  return {x, y, sigma * random.normal()};
}

/// Lines of six frames, half of each seen by the next, and 900 points of the ground.
DrawnBlock draw_block(const BlockNoise& noise, std::uint64_t seed) {
  Random random(seed);
  DrawnBlock drawn;
  drawn.block.camera = pinhole_camera(800, 600, 700);
  drawn.camera = drawn.block.camera;
  const double zoom = std::exp(noise.focal_length * random.normal());
  drawn.camera.fx_px *= zoom;
  drawn.camera.fy_px *= zoom;
  drawn.block.focal_length_sigma = noise.focal_length;
  drawn.block.distortion_sigma = 0.01;
  drawn.block.tilt_sigma_deg = noise.tilt_deg;
  drawn.block.heading_sigma_deg = noise.heading_deg;
  drawn.block.position_bias_sigma_m = noise.position_bias_m;
  Eigen::Vector3d bias_m = normal3(random, noise.position_bias_m);
  bias_m.z() = noise.with_elevation ? 300 : 5 * random.normal();
  const Lens lens = make_lens(drawn.camera);
  const Eigen::Vector3d boresight_rad = normal3(random, 2 * kRadPerDeg);
  std::vector<Eigen::Vector3d> points_m;
  for (int i = 0; i < 900; ++i) {
    const Eigen::Vector2d en_m(random.uniform(-210, 210), random.uniform(-150, 150));
    points_m.emplace_back(en_m.x(), en_m.y(), true_ground_m(en_m, noise.slope));
  }
  for (int line = 0; line < noise.lines; ++line) {
    for (int along = 0; along < 6; ++along) {
      const Attitude attitude{line % 2 == 0 ? 90.0 : -90.0, noise.tilt_deg * random.normal(),
                              noise.tilt_deg * random.normal()};
      FramePose pose{enu_from_camera({}, attitude),
                     {(along - 2.5) * 45, (line - (noise.lines - 1) / 2.0) * 45, kHeight_m}};
      pose.center_enu_m += normal3(random, 3);
      MeasuredPose measured;
      measured.sigma_en_m = noise.position_m;
      measured.sigma_up_m = noise.height_m;
      measured.center_enu_m = pose.center_enu_m + bias_m + noise.position_m * normal3(random, 1);
      measured.center_enu_m.z() = pose.center_enu_m.z() + bias_m.z() + noise.height_m * random.normal();
      const Eigen::Vector3d error_rad(noise.tilt_deg * random.normal(), noise.tilt_deg * random.normal(),
                                      noise.heading_deg * random.normal());
      if (noise.with_attitude) {
        measured.enu_from_camera = pose.enu_from_camera * turned_by(boresight_rad) * turned_by(error_rad * kRadPerDeg);
      }
      FrameFeatures features;
      features.pixel_sigma_px = 0.7;
      for (const Eigen::Vector3d& point_m : points_m) {
        const auto pixel = pixel_from_ray(lens, pose.enu_from_camera.transpose() * (point_m - pose.center_enu_m));
        const Eigen::Vector2d error_px(0.7 * random.normal(), 0.7 * random.normal());
        const bool seen = pixel && pixel->minCoeff() >= 0 && pixel->x() < drawn.camera.width_px &&
                          pixel->y() < drawn.camera.height_px;
        features.pixels.push_back(seen ? Eigen::Vector2d(*pixel + error_px) : Eigen::Vector2d(-1, -1));
      }
      drawn.truth.push_back(pose);
      drawn.block.measured.push_back(measured);
      drawn.block.features.push_back(features);
    }
  }
  const auto count = static_cast<int>(drawn.truth.size());
  for (int first = 0; first < count; ++first) {
    for (int second = first + 1; second < count; ++second) {
      FramePair pair{first, second, {}};
      for (int i = 0; i < static_cast<int>(points_m.size()); ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (drawn.block.features[static_cast<std::size_t>(first)].pixels[at].x() >= 0 &&
            drawn.block.features[static_cast<std::size_t>(second)].pixels[at].x() >= 0) {
          pair.matches.push_back({i, i});
        }
      }
      if (pair.matches.size() >= 20) drawn.block.pairs.push_back(pair);
    }
  }
  return drawn;
}

std::size_t nearest_frame(const AdjustedBlock& adjusted, const Eigen::Vector2d& en_m) {
  std::size_t nearest = 0;
  const auto away_m = [&](std::size_t k) { return (adjusted.poses[k].center_enu_m.head<2>() - en_m).norm(); };
  for (std::size_t k = 1; k < adjusted.poses.size(); ++k) nearest = away_m(k) < away_m(nearest) ? k : nearest;
  return nearest;
}

/// Where the ground lies that a map shows at a place from a frame.
std::optional<Eigen::Vector2d> true_place_m(const DrawnBlock& drawn, const AdjustedBlock& adjusted, std::size_t frame,
                                            const Eigen::Vector3d& place_m, double slope) {
  const FramePose& pose = adjusted.poses[frame];
  const auto pixel =
      pixel_from_ray(make_lens(adjusted.camera), pose.enu_from_camera.transpose() * (place_m - pose.center_enu_m));
  if (!pixel) return std::nullopt;
  const auto ray = ray_from_pixel(make_lens(drawn.camera), *pixel);
  if (!ray) return std::nullopt;
  const FramePose& truth = drawn.truth[frame];
  const Eigen::Vector3d direction = truth.enu_from_camera * *ray;
  Eigen::Vector2d at_m = place_m.head<2>();
  for (int round = 0; round < 20; ++round) {
    const double down_m = truth.center_enu_m.z() - true_ground_m(at_m, slope);
    at_m = truth.center_enu_m.head<2>() + direction.head<2>() * (down_m / -direction.z());
  }
  return at_m;
}

/// How far the other map lies off, bends and all.
double said_sigma_m(const BlockNoise& noise) {
  return std::hypot(noise.reference_m, noise.bend_m / std::sqrt(2));
}

/// Twelve ties of an adjusted block to another map, which is off by the same everywhere.
void tie_to_map(const DrawnBlock& drawn, const AdjustedBlock& adjusted, const BlockNoise& noise, Random& random,
                Block& block) {
  const GroundSurface ground = fit_surface(adjusted.points, {-250, -200}, {250, 200});
  const Eigen::Vector2d bias_m = normal3(random, noise.reference_m).head<2>();
  const double phase = random.uniform(-3, 3);
  block.reference_sigma_m = said_sigma_m(noise);
  block.surface_sigma_m = std::max(0.1, ground.spread_m);
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d en_m(random.uniform(-100, 100), random.uniform(-60, 60));
    ReferenceTie tie;
    tie.frame = static_cast<int>(nearest_frame(adjusted, en_m));
    tie.enu_m << en_m, ground.heights.height_m(en_m);
    tie.above_plane_m = tie.enu_m.z() - adjusted.plane->dot(Eigen::Vector3d(en_m.x(), en_m.y(), 1));
    const FramePose& pose = adjusted.poses[static_cast<std::size_t>(tie.frame)];
    const auto pixel =
        pixel_from_ray(make_lens(adjusted.camera), pose.enu_from_camera.transpose() * (tie.enu_m - pose.center_enu_m));
    const auto truth_m = true_place_m(drawn, adjusted, static_cast<std::size_t>(tie.frame), tie.enu_m, noise.slope);
    ASSERT_TRUE(pixel && truth_m);
    tie.pixel = *pixel;
    tie.sigma_m = noise.tie_m;
    const Eigen::Vector2d bend_m =
        noise.bend_m * Eigen::Vector2d(std::sin(truth_m->y() / 48 + phase), std::sin(truth_m->x() / 48 - phase));
    tie.reference_en_m = *truth_m + bend_m + bias_m + normal3(random, noise.tie_m).head<2>();
    block.reference_ties.push_back(tie);
  }
}

struct Consistency {
  double nees = 0;     ///< Mean of eᵀ P⁻¹ e over two.
  double rms_m = 0;    ///< Of the errors, per axis.
  double sigma_m = 0;  ///< As modelled.
};

/// Each drawn block is judged at one place, so that no two errors have anything in common.
Consistency consistency(const BlockNoise& noise, int blocks, bool at_the_edge) {
  Consistency mean;
  Random random(99);
  for (int i = 0; i < blocks; ++i) {
    DrawnBlock drawn = draw_block(noise, static_cast<std::uint64_t>(1000 + i));
    GroundPrior prior;
    if (noise.with_elevation) {
      prior.height_m = [&](const Eigen::Vector2d& en_m) { return true_ground_m(en_m, noise.slope); };
    }
    const auto adjust = [&] {
      return adjust_block(drawn.block, start_block(drawn.block),
                          join_tracks(drawn.block.pairs, drawn.block.features, 8), prior, 1, {});
    };
    AdjustedBlock adjusted = adjust();
    if (noise.reference_m > 0) {
      tie_to_map(drawn, adjusted, noise, random, drawn.block);
      MapAlignment alignment;
      alignment.reference_sigma_m = said_sigma_m(noise);
      do {
        adjusted = adjust();
      } while (loosen_ties(adjusted, alignment, drawn.block));
    }
    const Eigen::Vector2d low(-250, -200);
    const GroundSurface ground =
        prior.height_m ? sample_surface(prior, 5, adjusted.points, low, -low) : fit_surface(adjusted.points, low, -low);
    const Eigen::Vector2d en_m =
        at_the_edge ? Eigen::Vector2d(random.uniform(105, 135), 22.5 * noise.lines - random.uniform(0, 30))
                    : Eigen::Vector2d(random.uniform(-60, 60), random.uniform(-50, 50));
    const std::size_t nearest = nearest_frame(adjusted, en_m);
    const Eigen::Vector3d place_m(en_m.x(), en_m.y(), ground.heights.height_m(en_m));
    const auto truth_m = true_place_m(drawn, adjusted, nearest, place_m, noise.slope);
    EXPECT_TRUE(truth_m);
    if (!truth_m) continue;
    const Eigen::Vector2d error_m = *truth_m - en_m;
    const Eigen::Matrix2d covariance_m2 = map_covariance_m2(adjusted, ground, nearest, place_m);
    mean.nees += error_m.dot(covariance_m2.inverse() * error_m) / 2 / blocks;
    mean.rms_m += error_m.squaredNorm() / 2 / blocks;
    mean.sigma_m += covariance_m2.trace() / 2 / blocks;
  }
  mean.rms_m = std::sqrt(mean.rms_m);
  mean.sigma_m = std::sqrt(mean.sigma_m);
  return mean;
}

TEST(MapErrorThorough, ErrorsOfTheMapAreAsLargeAsItSays) {
  // Of 40 draws of two axes each, the mean of what should be 1 has a standard deviation of 0.16. Cauchy's loss takes
  // the more from what agrees, the less that is: a little below 1 is to be expected.
  struct Case {
    const char* name;
    BlockNoise noise;
    bool at_the_edge;
    double least;
  };
  BlockNoise no_bias;
  no_bias.position_bias_m = 0.01;
  BlockNoise no_attitude = no_bias;
  no_attitude.with_attitude = false;
  BlockNoise on_slope = no_bias;
  on_slope.slope = 0.1;
  BlockNoise strip = on_slope;  // whose tilt across the line only the attitudes tell
  strip.lines = 1;
  BlockNoise on_elevation = no_bias;  // which is exact, and taken for good to 3 m
  on_elevation.with_elevation = true;
  BlockNoise tied;
  tied.reference_m = 1;
  BlockNoise well_tied;  // what the frames themselves leave open counts
  well_tied.reference_m = 0.05;
  BlockNoise tied_to_bent = well_tied;
  tied_to_bent.bend_m = 2;
  for (const Case& one :
       {Case{"bias", {}, false, 0.6}, Case{"no_bias", no_bias, true, 0.6}, Case{"no_attitude", no_attitude, true, 0.6},
        Case{"slope", on_slope, true, 0.6}, Case{"strip", strip, true, 0.35},
        Case{"elevation", on_elevation, true, 0.35}, Case{"tied", tied, false, 0.6},
        Case{"well_tied", well_tied, true, 0.6}, Case{"bent", tied_to_bent, true, 0.2}}) {
    const Consistency found = consistency(one.noise, 40, one.at_the_edge);
    RecordProperty(one.name, format_fixed(found.nees, 2) + ": " + format_fixed(found.rms_m, 2) + " m, modelled " +
                                 format_fixed(found.sigma_m, 2) + " m");
    EXPECT_GT(found.nees, one.least) << one.name << ": " << found.rms_m << " m, modelled " << found.sigma_m;
    EXPECT_LT(found.nees, 1.4) << one.name << ": " << found.rms_m << " m, modelled " << found.sigma_m;
  }
}

TEST(MapError, FollowsFromEachOfTheTwelveNumbers) {
  // One frame with a distorting lens, over ground that slopes; every number is off by a little, all at once.
  AdjustedBlock block;
  block.camera = pinhole_camera(800, 600, 700);
  block.camera.distortion_model = DistortionModel::kBrownConrady;
  block.camera.distortion = {-0.2, 0.05};
  block.poses.push_back({enu_from_camera({}, {70, 5, -4}), {3, -2, kHeight_m}});
  const Eigen::Vector2d slope(0.3, -0.1);
  const auto plane_m = [&](const Eigen::Vector2d& en_m) { return slope.dot(en_m); };
  std::vector<double> heights_m;
  for (int row = -3; row <= 3; ++row) {
    for (int column = -3; column <= 3; ++column) heights_m.push_back(plane_m({100.0 * column, 100.0 * row}));
  }
  const GroundSurface ground{TerrainHeights({-300, -300}, 100, 7, heights_m), 0};
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    const Eigen::Vector2d en_m(random.uniform(-45, 45), random.uniform(-45, 45));
    const Eigen::Vector3d place_m(en_m.x(), en_m.y(), plane_m(en_m));
    Eigen::Matrix<double, FrameError::kSize, 1> off;
    const std::array<double, FrameError::kSize> sizes{1e-3, 1e-3, 1e-3, 0.1, 0.1,  0.1,
                                                      1e-3, 1e-3, 1e-3, 0.1, 1e-3, 1e-3};
    for (int i = 0; i < FrameError::kSize; ++i) off[i] = sizes[static_cast<std::size_t>(i)] * random.normal();
    off *= 0.01;
    FramePose pose = block.poses.front();
    pose.enu_from_camera = (turned_by(off.head<3>()) * pose.enu_from_camera.transpose()).transpose();
    pose.center_enu_m += off.segment<3>(3);
    Camera camera = block.camera;
    camera.fx_px *= std::exp(off[6]);
    camera.fy_px *= std::exp(off[6]);
    camera.distortion[0] += off[7];
    camera.distortion[1] += off[8];
    const FramePose& said = block.poses.front();
    const auto pixel =
        pixel_from_ray(make_lens(block.camera), said.enu_from_camera.transpose() * (place_m - said.center_enu_m));
    ASSERT_TRUE(pixel);
    const auto ray = ray_from_pixel(make_lens(camera), *pixel);
    ASSERT_TRUE(ray);
    const Eigen::Vector3d direction = pose.enu_from_camera * *ray;
    Eigen::Vector2d at_m = en_m;
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector2d from_m = at_m - said.center_enu_m.head<2>();
      const double height_m = plane_m(at_m) + off[9] + off.tail<2>().dot(from_m);
      at_m = pose.center_enu_m.head<2>() + direction.head<2>() * ((pose.center_enu_m.z() - height_m) / -direction.z());
    }
    const Eigen::Vector2d moved_m = at_m - en_m;
    block.frame_errors = {FrameError{off * off.transpose(), slope.transpose()}};
    if (round % 2 == 1) block.frame_errors.front().ground_slope.reset();  // the same slope is in the surface
    const Eigen::Matrix2d covariance_m2 = map_covariance_m2(block, ground, 0, place_m);
    EXPECT_LT((covariance_m2 - moved_m * moved_m.transpose()).norm(), 0.02 * moved_m.squaredNorm()) << round;
  }
}

TEST(MapError, GrowsTowardsTheEdgeAndIsInfiniteAboveTheCamera) {
  BlockNoise noise;
  noise.position_bias_m = 0.5;
  const DrawnBlock drawn = draw_block(noise, 5);
  const AdjustedBlock adjusted = adjust_block(drawn.block, start_block(drawn.block),
                                              join_tracks(drawn.block.pairs, drawn.block.features, 8), {}, 1, {});
  const GroundSurface ground = fit_surface(adjusted.points, {-250, -200}, {250, 200});
  const auto sigma_m = [&](std::size_t frame, const Eigen::Vector3d& place_m) {
    return std::sqrt(map_covariance_m2(adjusted, ground, frame, place_m).trace() / 2);
  };
  const double inside_m = sigma_m(8, {-20, 0, 0});
  const double outside_m = sigma_m(0, {-140, -100, 0});
  EXPECT_GT(inside_m, 0.5);
  EXPECT_GT(outside_m, 1.2 * inside_m);
  EXPECT_TRUE(std::isinf(sigma_m(0, {0, 0, 500})));
}

}  // namespace
}  // namespace pilotage
