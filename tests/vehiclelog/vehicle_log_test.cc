#include "pilotage/vehiclelog/vehicle_log.h"

#include <cstdlib>
#include <filesystem>

#include "testing/source_folder.h"
#include "vehiclelog/log_writers.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/read_file.h"

namespace pilotage {
namespace {

TEST(VehicleLog, FormatIsKnownByContent) {
  EXPECT_EQ(log_format_of(small_ulog()), LogFormat::kUlog);
  EXPECT_EQ(log_format_of(small_dataflash()), LogFormat::kDataFlash);
  EXPECT_EQ(log_format_of(small_telemetry()), LogFormat::kTelemetry);
  EXPECT_EQ(log_format_of(small_airsim()), LogFormat::kAirSim);
  EXPECT_FALSE(log_format_of("file,time_s\n"));
  EXPECT_FALSE(log_format_of(""));
}

TEST(VehicleLog, UnknownBytesAreAnErrorThatNamesTheFormats) {
  try {
    parse_vehicle_log("notes.txt", "hello", {});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("notes.txt: is no log that is known"), std::string::npos);
  }
}

TEST(VehicleLog, LogWithoutAnythingSaysWhatWasLost) {
  try {
    parse_vehicle_log("flight", ulog_head() + "???????", {});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("7 bytes hold no record"), std::string::npos) << error.what();
  }
}

TEST(VehicleLog, NotesSayWhatIsMissing) {
  const std::string log = ulog_head() + ulog_format(kPositionFormat) + ulog_stream(0, "vehicle_global_position") +
                          ulog_record(0, ulog_time(1).d(10).d(20).f(1)) + ulog_message('O', LogText().u(250, 2).str()) +
                          "\x09";
  const std::vector<std::string> notes = notes_of_log(parse_vehicle_log("flight", log, {}));
  const std::vector<std::string> expected{"1 byte holds no record that can be read",
                                          "the logger lost records 1 time, 0.2 s in all",
                                          "the file ends inside a record",
                                          "the log has no position by GNSS",
                                          "the log has no attitude",
                                          "the log has no capture or trigger of a camera"};
  EXPECT_EQ(notes, expected);
}

TEST(VehicleLog, DurationIsFromFirstToLast) {
  EXPECT_EQ(duration_s(parse_vehicle_log("f", small_ulog(), {})), 9.5);
}

// PILOTAGE_WRITE_CORPUS=1 writes the files instead of comparing them.
TEST(VehicleLog, FuzzCorpusIsWhatTheWritersWrite) {
  for (const std::string reader : {"ulog", "dataflash", "telemetry", "airsim_recording"}) {
    const std::filesystem::path folder = testing::source_folder() / "tests/fuzz/corpus" / reader;
    for (const auto& [name, bytes] : fuzz_corpus(reader)) {
      if (std::getenv("PILOTAGE_WRITE_CORPUS") != nullptr) {
        std::filesystem::create_directories(folder);
        write_file(folder / name, bytes, true);
      }
      EXPECT_EQ(read_file(folder / name), bytes) << reader << "/" << name;
    }
  }
}

}  // namespace
}  // namespace pilotage
