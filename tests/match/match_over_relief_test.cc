// Frames over hills, on a map that knows the heights and on one that does not.
#include <cmath>

#include "match/shot.h"
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using testing::match_shot;
using testing::Shot;
using testing::ShotAnswer;
using testing::ShotMap;

/// Hills 100 m apart, and a slope to the east.
struct Hills {
  double slope = 0;
  double height_m = 0;

  double operator()(const Eigen::Vector2d& at_m) const {
    return 40 + slope * at_m.x() +
           height_m / 2 * std::sin(at_m.x() * 2 * M_PI / 100) * std::cos(at_m.y() * 2 * M_PI / 100);
  }
};

ShotMap map_over(const Hills& hills, int tiles = 3) {
  testing::TexturedGround ground = testing::make_textured_ground(tiles);
  ground.height_m = hills;
  return ShotMap(ground);
}

Shot shot_from(double east_m, double north_m, const Attitude& attitude) {
  Shot shot;
  shot.east_m = east_m;
  shot.north_m = north_m;
  shot.attitude = attitude;
  shot.prior_off_m = {5, -7};
  return shot;
}

/// Squared, in standard deviations: 2 on average, 9 in one of 90.
double normalised_square(const ShotAnswer& answer) {
  return answer.error_m.dot(answer.result.fix->covariance_en_m2.inverse() * answer.error_m);
}

TEST(MatchOverRelief, TheAircraftIsFoundOnSlopes) {
  for (const double slope : {0.1, 0.3, 0.6}) {
    const ShotMap map = map_over({slope, 0});
    for (const double heading_deg : {0.0, 110.0, 250.0}) {
      const ShotAnswer answer = match_shot(map, shot_from(6, -9, {heading_deg, 2, -3}));
      ASSERT_EQ(answer.result.status, MatchStatus::kFix) << slope << " " << heading_deg;
      EXPECT_LT(answer.error_m.norm(), 1) << slope << " " << heading_deg;
      EXPECT_LT(answer.center_error_m.norm(), 0.6) << slope << " " << heading_deg;
      EXPECT_NEAR(answer.result.fix->pitch_deg, 2, 0.7) << slope << " " << heading_deg;
      EXPECT_NEAR(answer.result.fix->roll_deg, -3, 0.7) << slope << " " << heading_deg;
      EXPECT_NEAR(answer.result.fix->height_agl_m, map.ground.agl_m, 1.5) << slope << " " << heading_deg;
    }
  }
}

// An error of the heights at the footprint's edge is one of tilt, which moves the aircraft's place.
TEST(MatchOverRelief, TheMapSaysHowGoodItsHeightsAre) {
  testing::TexturedGround ground = testing::make_textured_ground();
  ground.height_m = Hills{0.1, 0};
  const auto area_of = [](const ShotAnswer& answer) { return answer.result.fix->covariance_en_m2.determinant(); };
  const Shot shot = shot_from(6, -9, {110, 2, -3});
  const auto told = [](double sigma_m) {
    MatchOptions options;
    options.elevation_sigma_m = sigma_m;
    return options;
  };
  const double silent = area_of(match_shot(ShotMap(ground), shot));
  ground.elevation_sigma_m = 4;
  const ShotMap coarse(ground);
  const double said = area_of(match_shot(coarse, shot));
  EXPECT_DOUBLE_EQ(area_of(match_shot(coarse, shot, told(1))), silent)
      << "the option counts, and 1 is taken where nobody says";
  EXPECT_GT(said, 1.5 * silent);
  EXPECT_DOUBLE_EQ(area_of(match_shot(coarse, shot, told(4))), said);
}

TEST(MatchOverRelief, TheAircraftIsFoundOverHills) {
  const ShotMap map = map_over({0.1, 12});
  for (int i = 0; i < 6; ++i) {
    const ShotAnswer answer = match_shot(map, shot_from(10.0 * i - 25, 8.0 * i - 20, {60.0 * i, 1, 2}));
    ASSERT_EQ(answer.result.status, MatchStatus::kFix) << i;
    EXPECT_LT(answer.error_m.norm(), 1) << i;
    EXPECT_LT(answer.center_error_m.norm(), 0.6) << i;
    EXPECT_LT(normalised_square(answer), 9) << i;
  }
}

TEST(MatchOverRelief, TheCameraMayLookFarAhead) {
  for (const double slope : {0.0, 0.3}) {
    const ShotMap map = map_over({slope, 6}, 5);
    for (const double heading_deg : {0.0, 90.0, 180.0}) {
      Shot shot = shot_from(0, 0, {heading_deg, 0, 0});
      shot.mount.pitch_deg = 45;
      const ShotAnswer answer = match_shot(map, shot);
      ASSERT_EQ(answer.result.status, MatchStatus::kFix) << slope << " " << heading_deg;
      EXPECT_LT(answer.error_m.norm(), 2.5) << slope << " " << heading_deg;
      EXPECT_LT(normalised_square(answer), 9) << slope << " " << heading_deg;
    }
  }
}

TEST(MatchOverRelief, FarMorePairsAgreeThanOnAMapWithoutHeights) {
  const ShotMap map = map_over({0.25, 10});
  testing::TexturedGround level_ground = map.ground;
  level_ground.height_m = nullptr;
  ShotMap unknowing(level_ground);
  unknowing.ground = map.ground;  // what frames show
  const Shot shot = shot_from(4, 3, {75, 0, 0});
  const ShotAnswer knowing = match_shot(map, shot);
  const ShotAnswer level = match_shot(unknowing, shot);
  ASSERT_EQ(knowing.result.status, MatchStatus::kFix);
  EXPECT_GT(knowing.result.stats.inliers, 1.5 * level.result.stats.inliers);
}

TEST(MatchOverRelief, AnUnknownHeadingIsFoundToo) {
  const ShotMap map = map_over({0.2, 8});
  Shot shot = shot_from(5, 5, {140, 0, 0});
  shot.attitude_off.yaw_deg = -140;  // the prior says north
  MatchOptions options;
  options.yaw_sigma_deg = 180;
  const ShotAnswer answer = match_shot(map, shot, options);
  ASSERT_EQ(answer.result.status, MatchStatus::kFix);
  EXPECT_LT(answer.error_m.norm(), 1);
}

}  // namespace
}  // namespace pilotage
