#include "pilotage/geo/ecef.h"

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(Ecef, KnownPlaces) {
  EXPECT_LT((ecef_from_geodetic({0, 0}, 0) - Eigen::Vector3d(6378137, 0, 0)).norm(), 1e-9);
  EXPECT_LT((ecef_from_geodetic({90, 0}, 100) - Eigen::Vector3d(0, 6378237, 0)).norm(), 1e-9);
  EXPECT_LT((ecef_from_geodetic({0, 90}, 0) - Eigen::Vector3d(0, 0, 6356752.314245)).norm(), 1e-5);
}

TEST(Ecef, ThereAndBack) {
  for (const double lat_deg : {-89.9, -45.0, 0.0, 12.3, 88.0}) {
    for (const double height_m : {-500.0, 0.0, 12000.0}) {
      const Eigen::Vector3d ecef_m = ecef_from_geodetic({-120.5, lat_deg}, height_m);
      const GeodeticPoint point = geodetic_from_ecef(ecef_m);
      EXPECT_NEAR(point.lat_deg, lat_deg, 1e-12);
      EXPECT_NEAR(point.lon_deg, -120.5, 1e-12);
      EXPECT_NEAR(height_from_ecef(ecef_m, point), height_m, 1e-7);
      EXPECT_LT((enu_from_ecef(point) * enu_from_ecef(point).transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
      EXPECT_NEAR((enu_from_ecef(point) * (ecef_from_geodetic(point, height_m + 1) - ecef_m)).z(), 1, 1e-8);
    }
  }
}

}  // namespace
}  // namespace pilotage
