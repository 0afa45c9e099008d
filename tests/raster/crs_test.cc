#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

TEST(Crs, KnowsWhatItIs) {
  const Crs utm = Crs::from_user_input("EPSG:32750");
  EXPECT_EQ(utm.name(), "WGS 84 / UTM zone 50S");
  EXPECT_EQ(utm.authority(), "EPSG:32750");
  EXPECT_TRUE(utm.is_projected());
  EXPECT_FALSE(utm.is_geographic());
  EXPECT_FALSE(utm.has_height());
  EXPECT_EQ(utm.metres_per_unit(), 1);
  EXPECT_TRUE(Crs::wgs84().is_geographic());
  EXPECT_TRUE(std::isnan(Crs::wgs84().metres_per_unit()));
  EXPECT_NEAR(Crs::from_user_input("EPSG:2994").metres_per_unit(), 0.3048, 1e-12);
  EXPECT_TRUE(Crs::from_user_input("EPSG:4979").has_height());
  EXPECT_TRUE(Crs::from_user_input("EPSG:32633+5773").has_height());
}

TEST(Crs, WktIsVersionOneWhereThatSaysTheSame) {
  EXPECT_TRUE(Crs::from_user_input("EPSG:32633").wkt().starts_with("PROJCS["));
  EXPECT_TRUE(Crs::from_user_input("EPSG:3857").same_as(Crs::from_user_input(Crs::from_user_input("EPSG:3857").wkt())));
  // An ellipsoidal height is no axis of WKT 1's GEOGCS.
  EXPECT_TRUE(Crs::from_user_input("EPSG:4979").has_height());
}

TEST(Crs, ComparesWhatItMeansNotHowItIsWritten) {
  const Crs code = Crs::from_user_input("EPSG:32633");
  EXPECT_TRUE(code.same_as(Crs::from_user_input("+proj=utm +zone=33 +datum=WGS84 +units=m")));
  EXPECT_FALSE(code.same_as(Crs::from_user_input("EPSG:32634")));
  EXPECT_TRUE(Crs::wgs84().same_as(Crs::from_user_input("OGC:CRS84")));
  EXPECT_FALSE(code.same_as(Crs()));
}

TEST(Crs, BadInputIsAUsageError) {
  for (const char* text : {"", "EPSG:0", "nonsense", "PROJCS[\"broken\"", "/nowhere/at.all"}) {
    EXPECT_THROW(Crs::from_user_input(text), UsageError) << text;
  }
  EXPECT_THROW(Crs().name(), UsageError);
  try {
    Crs::from_user_input("EPSG:0");
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("EPSG:0"), std::string::npos);
  }
}

TEST(CrsTransform, GivesEastingFirst) {
  const CrsTransform transform(Crs::from_user_input("EPSG:32633"));
  const auto map = transform.map_from_geodetic({15, 45});
  ASSERT_TRUE(map);
  EXPECT_NEAR(map->x(), 500000, 1e-6);
  // Meridian arc to 45° N, 4,984,944.378 m (Snyder, "Map projections", USGS 1395, 1987, eq. 3-21 on WGS 84), times
  // 0.9996.
  EXPECT_NEAR(map->y(), 0.9996 * 4984944.378, 1e-2);
  const auto back = transform.geodetic_from_map(*map);
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->lon_deg, 15, 1e-10);
  EXPECT_NEAR(back->lat_deg, 45, 1e-10);

  const CrsTransform degrees(Crs::wgs84());  // latitude first by its authority, not here
  EXPECT_NEAR(degrees.map_from_geodetic({15, 45})->x(), 15, 1e-12);
}

TEST(CrsTransform, SaysNothingOutsideTheDomain) {
  const CrsTransform gnomonic(Crs::from_user_input("+proj=gnom +lat_0=0 +lon_0=0 +datum=WGS84"));
  EXPECT_TRUE(gnomonic.map_from_geodetic({0, 45}));
  EXPECT_FALSE(gnomonic.map_from_geodetic({180, 0}));  // the other half of the Earth
  EXPECT_FALSE(gnomonic.map_from_geodetic({0, 91}));
  EXPECT_FALSE(gnomonic.map_from_geodetic({NAN, 0}));
  EXPECT_FALSE(CrsTransform(Crs::from_user_input("EPSG:32633")).geodetic_from_map({INFINITY, 0}));
}

TEST(CrsTransform, UsesTheHorizontalPartOfACompoundCrs) {
  const CrsTransform transform(Crs::from_user_input("EPSG:32633+5773"));
  EXPECT_NEAR(transform.map_from_geodetic({15, 45})->x(), 500000, 1e-6);
}

TEST(HeightTransform, TakesTheGeoidOff) {
  // Geoid height of EGM96 at 0° N, 0° E: 17.16 m (NGA's table of EGM96 undulations).
  const HeightTransform transform(Crs::from_user_input("EPSG:4979"));
  const auto amsl_m = transform.amsl_m({0, 0}, 100);
  ASSERT_TRUE(amsl_m);
  EXPECT_NEAR(*amsl_m, 100 - 17.16, 0.05);
}

}  // namespace
}  // namespace pilotage
