#include <filesystem>

#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {
namespace {

constexpr const char* kNoLogs = "no real logs: set PILOTAGE_DATA to the folder that holds logs/";

class RealLogs : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::real_data_folder() / "logs";
    if (!std::filesystem::is_directory(folder_)) GTEST_SKIP() << kNoLogs;
  }
  std::string bytes_of(const std::string& file) const { return read_file(folder_ / file); }
  static VehicleLog parse(const std::string& bytes) { return parse_vehicle_log("log", bytes, {}); }

  std::filesystem::path folder_;
};

TEST_F(RealLogs, Px4WithGnss) {
  const VehicleLog log = parse(bytes_of("sample_px4_events.ulg"));
  EXPECT_EQ(log.estimate.positions.size(), 109U);
  EXPECT_EQ(log.estimate.attitudes.size(), 622U);
  EXPECT_EQ(log.gnss.positions.size(), 423U) << "of 583 those with a three-dimensional fix";
  EXPECT_TRUE(log.truth.positions.empty());
  EXPECT_EQ(log.losses.bytes_skipped, 0);
  EXPECT_EQ(log.losses.bad_times, 0);
}

TEST_F(RealLogs, Px4SimulationKnowsTheTruth) {
  const VehicleLog log = parse(bytes_of("sample_logging_tagged_and_default_params.ulg"));
  EXPECT_EQ(log.truth.positions.size(), 109U);
  EXPECT_EQ(log.truth.attitudes.size(), 1078U);
  EXPECT_EQ(log.truth.velocities.size(), 540U);
  EXPECT_TRUE(log.estimate.positions.empty()) << "vehicle_local_position is not valid in this log";
  EXPECT_EQ(log.gnss.positions.size(), 30U);
}

TEST_F(RealLogs, Px4WithoutAPositionOfItsOwn) {
  const VehicleLog log = parse(bytes_of("sample_log_small.ulg"));
  EXPECT_EQ(log.estimate.attitudes.size(), 1298U);
  EXPECT_TRUE(log.captures.empty());
  EXPECT_TRUE(log.estimate.positions.empty());
  EXPECT_EQ(log.gnss.positions.size(), 32U);
  EXPECT_EQ(log.losses.dropouts, 1);
}

TEST_F(RealLogs, ArduPilot) {
  const VehicleLog log = parse(bytes_of("ardupilot_test.BIN"));
  EXPECT_EQ(log.format, LogFormat::kDataFlash);
  EXPECT_EQ(log.estimate.attitudes.size(), 24U);
  EXPECT_EQ(log.estimate.positions.size(), 23U);
  EXPECT_EQ(log.gnss.positions.size(), 5U);
}

TEST_F(RealLogs, CutAnywhereIsAnErrorOrAStatedLoss) {
  for (const char* file : {"sample_px4_events.ulg", "sample_logging_tagged_and_default_params.ulg",
                           "sample_log_small.ulg", "ardupilot_test.BIN"}) {
    const std::string bytes = bytes_of(file);
    const std::size_t whole = parse(bytes).estimate.attitudes.size();
    int read = 0;
    for (std::size_t size = 1; size < bytes.size(); size += 1 + bytes.size() / 40) {
      try {
        EXPECT_LE(parse(bytes.substr(0, size)).estimate.attitudes.size(), whole) << file << " " << size;
        ++read;
      } catch (const DataError& error) {
        EXPECT_NE(std::string(error.what()), "");
      }
    }
    EXPECT_GT(read, 10) << file;
  }
}

}  // namespace
}  // namespace pilotage
