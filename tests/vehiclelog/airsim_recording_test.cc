#include "vehiclelog/log_writers.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {
namespace {

constexpr LogOrigin kOrigin{{16.5, 55.5}, 100};

TEST(AirSimRecording, IsReadBackFromItsOrigin) {
  const VehicleLog log = parse_vehicle_log("rec", small_airsim(), kOrigin);
  EXPECT_EQ(log.format, LogFormat::kAirSim);
  ASSERT_EQ(log.truth.positions.size(), 10U);
  EXPECT_EQ(log.truth.positions[0].amsl_m, 220);
  // 1° of longitude is 63,200 m at 55.5° (a cos φ/√(1−e² sin²φ) · π/180).
  EXPECT_NEAR(log.truth.positions[9].point.lon_deg, 16.5 + 63 / 63200.0, 1e-6);
  EXPECT_NEAR(log.truth.positions[9].point.lat_deg, 55.5, 1e-7);
  EXPECT_NEAR(log.truth.attitudes.at(0).attitude.yaw_deg, 90, 1e-4);
  ASSERT_EQ(log.captures.size(), 10U);
  EXPECT_EQ(log.captures[0].file, "images/img_Drone1_3_0_1.png");
  EXPECT_TRUE(log.estimate.positions.empty());
}

TEST(AirSimRecording, NeedsAnOrigin) {
  EXPECT_THROW(parse_vehicle_log("rec", small_airsim(), {}), UsageError);
}

TEST(AirSimRecording, SecondVehicleBrokenRowsAndCrlf) {
  std::string text;
  for (const char c : small_airsim()) text += c == '\n' ? "\r\n" : std::string(1, c);
  text += "Drone2\t1700000011000\t0\t0\t0\t1\t0\t0\t0\ta.png\r\n";
  text +=
      "Drone1\t1700000011000\tnan\t0\t0\t1\t0\t0\t0\ta.png;b.png\r\nDrone1\t1700000012000\t1\t0\t0\t0\t0\t0\t0\ta.png;"
      "b.png\r\n";
  const VehicleLog log = parse_vehicle_log("rec", text, kOrigin);
  EXPECT_EQ(log.losses.other_sources, 1);
  EXPECT_EQ(log.losses.bad_values, 2);
  ASSERT_EQ(log.captures.size(), 11U);
  EXPECT_EQ(log.captures.back().file, "images/a.png");
  EXPECT_FALSE(log.captures.back().attitude);
}

TEST(AirSimRecording, MissingColumnIsAnError) {
  EXPECT_THROW(parse_vehicle_log("rec", "VehicleName\tTimeStamp\tPOS_X\n", kOrigin), DataError);
}

TEST(AirSimRecording, CutAtEveryByteIsAnErrorOrAStatedLoss) {
  const std::string text = small_airsim();
  for (std::size_t size = 0; size < text.size(); ++size) {
    try {
      EXPECT_LE(parse_vehicle_log("rec", text.substr(0, size), kOrigin).truth.positions.size(), 10U);
    } catch (const DataError&) {
    }
  }
}

}  // namespace
}  // namespace pilotage
