#include "pilotage/geo/enu_from_grid.h"

#include <algorithm>
#include <numbers>

#include <GeographicLib/PolarStereographic.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

using Inverse = std::function<std::optional<GeodeticPoint>(const Eigen::Vector2d&)>;

/// Largest error of the linear map over a circle around a grid point.
double worst_error_m(const Inverse& inverse, const Eigen::Vector2d& center_m, double distance_m) {
  const Eigen::Matrix2d matrix = enu_from_grid(center_m, 100, inverse);
  const LocalFrame frame(*inverse(center_m));
  double worst = 0;
  for (int i = 0; i < 32; ++i) {
    const double angle = i * std::numbers::pi / 16;
    const Eigen::Vector2d step = distance_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d truth = frame.enu_from_geodetic(*inverse(center_m + step)).head<2>();
    worst = std::max(worst, (truth - matrix * step).norm());
  }
  return worst;
}

std::optional<GeodeticPoint> from_utm(const Eigen::Vector2d& p) {
  double lat = 0, lon = 0;
  GeographicLib::TransverseMercator::UTM().Reverse(117, p.x() - 500000, p.y(), lat, lon);
  return GeodeticPoint{lon, lat};
}

std::optional<GeodeticPoint> from_ups(const Eigen::Vector2d& p) {
  double lat = 0, lon = 0;
  GeographicLib::PolarStereographic::UPS().Reverse(true, p.x(), p.y(), lat, lon);
  return GeodeticPoint{lon, lat};
}

// The bounds that MapTile and docs/methods/map-database.md state.
TEST(EnuFromGrid, ErrorStaysBelowItsBoundOverAllOfUtmAndUps) {
  double utm_1km = 0, utm_2km = 0, ups_1km = 0;
  for (double northing = 0; northing <= 9300000; northing += 155000) {
    for (double easting = 166000; easting <= 834000; easting += 66800) {
      utm_1km = std::max(utm_1km, worst_error_m(from_utm, {easting, northing}, 1000));
      utm_2km = std::max(utm_2km, worst_error_m(from_utm, {easting, northing}, 2000));
    }
  }
  for (double x = -800000; x <= 800000; x += 160000) {
    for (double y = -800000; y <= 800000; y += 160000) {
      ups_1km = std::max(ups_1km, worst_error_m(from_ups, {x, y}, 1000));
    }
  }
  RecordProperty("utm_1km_mm", std::to_string(utm_1km * 1000));
  RecordProperty("utm_2km_mm", std::to_string(utm_2km * 1000));
  RecordProperty("ups_1km_mm", std::to_string(ups_1km * 1000));
  EXPECT_LT(utm_1km, 0.005);
  EXPECT_LT(utm_2km, 4 * 0.005);
  EXPECT_LT(ups_1km, 0.007);
  EXPECT_GT(utm_1km, 0.001);  // a bound that is never approached would be wrong in the documents
}

TEST(EnuFromGrid, TurnsByTheConvergence) {
  double lat = 0, lon = 0, convergence_deg = 0, scale = 0;
  GeographicLib::TransverseMercator::UTM().Reverse(117, 200000, 6000000, lat, lon, convergence_deg, scale);
  const Eigen::Matrix2d matrix = enu_from_grid({700000, 6000000}, 100, from_utm);
  const double angle = convergence_deg * std::numbers::pi / 180;  // of grid north, clockwise from true north
  Eigen::Matrix2d want;
  want << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
  EXPECT_LT((matrix - want / scale).norm(), 1e-9);
}

TEST(EnuFromGrid, RefusesWhatHasNoPlace) {
  const auto nowhere = [](const Eigen::Vector2d&) { return std::optional<GeodeticPoint>(); };
  EXPECT_THROW(enu_from_grid({0, 0}, 100, nowhere), DataError);
  const auto collapsed = [](const Eigen::Vector2d&) { return std::optional(GeodeticPoint{10, 20}); };
  EXPECT_THROW(enu_from_grid({0, 0}, 100, collapsed), DataError);
}

}  // namespace
}  // namespace pilotage
