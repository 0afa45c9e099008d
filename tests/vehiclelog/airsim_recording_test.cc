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
  EXPECT_EQ(log.losses.other_sources.at("vehicle Drone2"), 1);
  EXPECT_EQ(log.losses.bad_values, 2);
  ASSERT_EQ(log.captures.size(), 11U);
  EXPECT_EQ(log.captures.back().file, "images/a.png");
  EXPECT_FALSE(log.captures.back().attitude);
}

/// Eastward at 120 m, one row of `cell` a second.
std::string recording(const std::string& header, const std::string& vehicle, const std::string& cell) {
  std::string text = header + "\n";
  for (int second = 1; second <= 3; ++second) {
    text += vehicle + std::to_string(1700000000000 + second * 1000) + "\t0\t" + std::to_string(6.3 * second) +
            "\t-120\t0.7071068\t0\t0\t0.7071068\t" + cell + "\n";
  }
  return text;
}
constexpr const char* kHeader = "VehicleName\tTimeStamp\tPOS_X\tPOS_Y\tPOS_Z\tQ_W\tQ_X\tQ_Y\tQ_Z\tImageFile";

// Columns are sought once, not in every row, and what lies behind them is not looked at.
TEST(AirSimRecording, AWideFirstLineIsRefusedAndWideRowsCostTheirBytes) {
  const std::string wide(2000, '\t');
  EXPECT_THROW(
      {
        try {
          parse_vehicle_log("rec", recording(std::string(kHeader) + wide, "D\t", "img_D_3_0_7.png"), kOrigin);
        } catch (const DataError& error) {
          EXPECT_STREQ(error.what(), "rec: line 1: an AirSim recording of more than 1000 columns");
          throw;
        }
      },
      DataError);
  const std::string many(1'000'000, '\t');
  EXPECT_EQ(parse_vehicle_log("rec", recording(kHeader, "D\t", "img_D_3_0_7.png" + many), kOrigin).captures.size(), 3U);
}

TEST(AirSimRecording, ManyOtherVehiclesAreCountedTogether) {
  std::string text = recording(kHeader, "D\t", "img_D_3_0_7.png");
  for (int i = 0; i < 500; ++i) text += "E" + std::to_string(i) + "\t1700000009000\t0\t0\t0\t1\t0\t0\t0\ta.png\n";
  const VehicleLog log = parse_vehicle_log("rec", text, kOrigin);
  EXPECT_EQ(log.losses.other_sources.size(), 9U);
  EXPECT_EQ(log.losses.other_sources.at("other sources"), 492);
}

TEST(AirSimRecording, HeadersOfTheFirstVersionsAreRead) {
  const VehicleLog today = parse_vehicle_log("rec", recording(kHeader, "D\t", "img_D_3_0_7.png"), kOrigin);
  const std::string no_vehicle = "TimeStamp\tPOS_X\tPOS_Y\tPOS_Z\tQ_W\tQ_X\tQ_Y\tQ_Z\tImageFile";
  const std::string first =
      "Timestamp\tPosition(x)\tPosition(y)\tPosition(z)\tOrientation(w)\tOrientation(x)\tOrientation(y)\t"
      "Orientation(z)\tImageName";
  for (const std::string& header : {no_vehicle, first, "\xEF\xBB\xBF" + no_vehicle}) {
    const VehicleLog log = parse_vehicle_log("rec", recording(header, "", "img_3_0_7.png"), kOrigin);
    ASSERT_EQ(log.truth.positions.size(), 3U) << header;
    EXPECT_EQ(log.truth.positions[2].point.lon_deg, today.truth.positions[2].point.lon_deg);
    EXPECT_EQ(log.truth.attitudes.size(), 3U);
    EXPECT_EQ(log.captures.at(0).file, "images/img_3_0_7.png");
  }
}

TEST(AirSimRecording, TheSceneIsTakenOfTheCameraThatLooksDown) {
  const auto file_of = [](const std::string& cell) {
    const VehicleLog log = parse_vehicle_log("rec", recording(kHeader, "My_Drone\t", cell), kOrigin);
    return log.captures.at(0).file;
  };
  EXPECT_EQ(file_of("img_My_Drone_0_2_7.png;img_My_Drone_0_0_7.png"), "images/img_My_Drone_0_0_7.png");
  EXPECT_EQ(file_of("img_0_5_7.png;img_0_0_7.png"), "images/img_0_0_7.png");
  EXPECT_EQ(file_of("img_D_front_center_0_7.png;img_D_bottom_center_0_7.png"), "images/img_D_bottom_center_0_7.png");
  EXPECT_EQ(file_of("img_D_0_0_7.png;img_D_3_0_7.png;img_D_3_2_7.pfm"), "images/img_D_3_0_7.png");
  EXPECT_EQ(file_of("mine.png;other.png"), "images/mine.png") << "a name that says nothing";
  const VehicleLog log =
      parse_vehicle_log("rec", recording(kHeader, "D\t", "img_D_0_2_7.png;img_D_0_0_7.png"), kOrigin);
  EXPECT_EQ(log.losses.other_sources.at("image type 2"), 3);
  EXPECT_THROW(parse_vehicle_log("rec", recording(kHeader, "D\t", "img_D_0_1_7.pfm;img_D_0_5_7.png"), kOrigin),
               DataError)
      << "no scene";
}

TEST(AirSimRecording, MissingColumnIsAnError) {
  try {
    parse_vehicle_log("rec", "Timestamp\tSpeed (kmph)\tThrottle\tImageName\n", kOrigin);
    FAIL() << "a car's first recording, without positions";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("\"POS_X\" (or \"Position(x)\")"), std::string::npos) << error.what();
  }
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
