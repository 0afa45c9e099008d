#include "pilotage/airsim/airsim_geometry.h"

#include <gtest/gtest.h>

#include "pilotage/camera/attitude.h"

namespace pilotage {
namespace {

TEST(AirsimGeometry, PlacesComeBack) {
  const AirsimHome home{{16.5, 55.5}, 30};
  for (const Eigen::Vector3d& ned : {Eigen::Vector3d(0, 0, 0), {1234, -987, -120}, {-20000, 30000, 5}}) {
    const AirsimPlace place = place_from_ned(home, ned);
    EXPECT_LT((ned_from_place(home, place) - ned).norm(), 1e-6) << ned.transpose();
    EXPECT_DOUBLE_EQ(place.altitude_m, 30 - ned.z());
  }
  const AirsimPlace north = place_from_ned(home, {1000, 0, 0});
  EXPECT_NEAR(north.point.lat_deg, 55.5 + 1000 / 111332.8, 1e-8);  // a degree of the meridian at 55.5°
  EXPECT_NEAR(north.point.lon_deg, 16.5, 1e-12);
}

TEST(AirsimGeometry, AttitudesComeBack) {
  for (const Attitude& attitude : {Attitude{10, 20, 30}, {-170, -80, 5}, {90, 0, -179}, {0, 0, 0}}) {
    const Attitude back = attitude_of(ned_from_body(attitude));
    EXPECT_NEAR(back.yaw_deg, attitude.yaw_deg, 1e-9);
    EXPECT_NEAR(back.pitch_deg, attitude.pitch_deg, 1e-9);
    EXPECT_NEAR(back.roll_deg, attitude.roll_deg, 1e-9);
    const Eigen::Matrix3d rotation = ned_from_body(attitude);
    EXPECT_LT((rotation_of(quaternion_of(rotation)) - rotation).norm(), 1e-6);
  }
  const Eigen::Matrix3d down = ned_from_body({40, 90, 0});
  EXPECT_LT((ned_from_body(attitude_of(down)) - down).norm(), 1e-9);
}

TEST(AirsimGeometry, QuaternionsNeedNoLength) {
  EXPECT_LT((rotation_of({2, 0, 0, 2}) - ned_from_body({90, 0, 0})).norm(), 1e-12);
  EXPECT_EQ(rotation_of({0, 0, 0, 0}), Eigen::Matrix3d::Identity());
  EXPECT_EQ(rotation_of({std::nanf(""), 0, 0, 1}), Eigen::Matrix3d::Identity());
}

TEST(AirsimGeometry, CamerasLookAlongTheirX) {
  // AirSim's bottom camera: pitched down by 90°, the image's right to the right wing.
  EXPECT_LT((airsim_camera_rotation({}) - rotation_zyx(0, -90, 0)).norm(), 1e-12);
  // A mount that looks ahead is no rotation to AirSim.
  EXPECT_LT((airsim_camera_rotation({0, 90, 0}) - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(AirsimGeometry, ACameraSeesTheSameByEitherWay) {
  const CameraMount mount{5, 20, -7};
  const Attitude attitude{100, 3, -4};
  const Attitude alone = attitude_of_camera(ned_from_body(attitude) * airsim_camera_rotation(mount));
  EXPECT_LT((enu_from_camera({}, alone) - enu_from_camera(mount, attitude)).norm(), 1e-12);
}

}  // namespace
}  // namespace pilotage
