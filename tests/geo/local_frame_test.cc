#include "pilotage/geo/local_frame.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

TEST(LocalFrame, AgreesWithGeographicLib) {
  Random random(seed_from_name("LocalFrame.AgreesWithGeographicLib"));
  for (int trial = 0; trial < 200; ++trial) {
    const GeodeticPoint origin{random.uniform(-180, 180), random.uniform(-89.9, 89.9)};
    const double origin_height_m = random.uniform(-400, 8000);
    const LocalFrame frame(origin, origin_height_m);
    const GeographicLib::LocalCartesian oracle(origin.lat_deg, origin.lon_deg, origin_height_m);
    const Eigen::Vector3d enu(random.uniform(-5e5, 5e5), random.uniform(-5e5, 5e5), random.uniform(-1000, 9000));

    double lat = 0, lon = 0, height = 0;
    oracle.Reverse(enu.x(), enu.y(), enu.z(), lat, lon, height);
    const GeodeticPoint point = frame.geodetic_from_enu(enu);
    EXPECT_NEAR(point.lat_deg, lat, 1e-12);
    EXPECT_NEAR(unwrap_lon_deg(point.lon_deg, lon), lon, 1e-11);
    EXPECT_LT((frame.enu_from_geodetic({lon, lat}, height) - enu).norm(), 1e-8);
  }
}

TEST(LocalFrame, RefusesWhatIsNotOnEarth) {
  EXPECT_THROW(LocalFrame({0, 91}), UsageError);
  EXPECT_THROW(LocalFrame({std::nan(""), 0}), UsageError);
}

TEST(WrapLon, StaysInHalfOpenInterval) {
  EXPECT_EQ(wrap_lon_deg(180), -180);
  EXPECT_EQ(wrap_lon_deg(-180), -180);
  EXPECT_NEAR(wrap_lon_deg(190), -170, 1e-12);
  EXPECT_NEAR(unwrap_lon_deg(-179, 179), 181, 1e-12);
}

}  // namespace
}  // namespace pilotage
