#include "pilotage/mapdb/map_purpose.h"

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/camera/camera_text.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

UtcTime at(const char* text) {
  return parse_utc_time(text).value();
}

MapPurpose harbour() {
  return {"harbour", 7, at("2026-03-01T06:00:00Z"), at("2026-06-01T00:00:00Z")};
}

class MapPurposeTest : public ::testing::Test {
 protected:
  MapReader map_with(const std::vector<MapInfoEntry>& entries) const {
    testing::SmallMap map = testing::make_small_map();
    map.info.insert(map.info.end(), entries.begin(), entries.end());
    const auto path = folder_ / "map.gpkg";
    testing::write_map(path, map, true);
    return MapReader::open_unverified(path);
  }

  testing::TemporaryFolder folder_;
};

TEST_F(MapPurposeTest, IsReadAsItWasWritten) {
  EXPECT_EQ(map_with(purpose_entries(harbour())).purpose(), harbour());
  EXPECT_EQ(map_with({}).purpose(), MapPurpose{});
  EXPECT_EQ(purpose_text(harbour()),
            "mission \"harbour\", map version 7, made 2026-03-01T06:00:00Z, valid until 2026-06-01T00:00:00Z");
  EXPECT_TRUE(purpose_entries({}).empty()) << "what is not said changes no byte";
}

TEST_F(MapPurposeTest, TheReaderRefusesWhatIsNoPurpose) {
  const std::vector<std::pair<MapInfoEntry, std::string>> wrong = {
      {{"purpose.mission_name", ""}, "mission_name is not 1 to 100 bytes"},
      {{"purpose.mission_name", std::string(101, 'x')}, "mission_name is not 1 to 100 bytes"},
      {{"purpose.mission_name", "a\nb"}, "without control characters"},
      {{"purpose.map_version", "0"}, "map_version = 0 is outside [1, 2147483647]"},
      {{"purpose.map_version", "7 "}, "is not a number"},
      {{"purpose.map_version", "2147483648"}, "is outside"},
      {{"purpose.created", "yesterday"}, "is not a time like 2026-03-01T06:30:00Z"},
      {{"purpose.valid_until", "2026-06-01"}, "is not a time like 2026-03-01T06:30:00Z"},
      {{"purpose.altitude", "120"}, "purpose.altitude is not known"}};
  for (const auto& [entry, message] : wrong) {
    const std::vector<MapInfoEntry> entries = {entry};
    EXPECT_THAT([&] { map_with(entries); }, ThrowsMessage<DataError>(HasSubstr(message)));
    EXPECT_FALSE(verify_map(folder_ / "map.gpkg").ok()) << entry.key;
  }
  MapPurpose reversed = harbour();
  std::swap(reversed.created, reversed.valid_until);
  EXPECT_THAT([&] { map_with(purpose_entries(reversed)); },
              ThrowsMessage<DataError>(HasSubstr("is not after created")));
}

TEST_F(MapPurposeTest, WhatIsNotAskedForIsNotChecked) {
  check_purpose(map_with({}), {});
  check_purpose(map_with(purpose_entries(harbour())), {});
}

TEST_F(MapPurposeTest, RefusesAnotherMissionAndAnOlderVersion) {
  const MapReader map = map_with(purpose_entries(harbour()));
  MapRequirements required;
  required.mission_name = "harbour";
  required.min_version = 7;
  check_purpose(map, required);
  required.min_version = 8;
  EXPECT_THAT([&] { check_purpose(map, required); },
              ThrowsMessage<IntegrityError>(HasSubstr("is map version 7, and at least 8 is asked for")));
  required.mission_name = "Harbour";
  EXPECT_THAT([&] { check_purpose(map, required); },
              ThrowsMessage<IntegrityError>(HasSubstr("is for the mission \"harbour\", and \"Harbour\" is asked for")));
}

TEST_F(MapPurposeTest, AMapThatSaysNothingIsNotWhatIsAskedFor) {
  const MapReader map = map_with({});
  MapRequirements required;
  required.min_version = 1;
  EXPECT_THAT([&] { check_purpose(map, required); }, ThrowsMessage<IntegrityError>(HasSubstr("has no map version")));
  required.mission_name = "harbour";
  EXPECT_THAT([&] { check_purpose(map, required); },
              ThrowsMessage<IntegrityError>(HasSubstr("does not say for which mission")));
}

TEST_F(MapPurposeTest, RefusesAnExpiredMapAndAClockThatIsBehind) {
  const MapReader map = map_with(purpose_entries(harbour()));
  MapRequirements required;
  for (const char* good : {"2026-03-01T06:00:00Z", "2026-02-28T12:00:00Z", "2026-05-31T23:59:59Z"}) {
    required.now = at(good);
    check_purpose(map, required);
  }
  required.now = at("2026-06-01T00:00:00Z");
  EXPECT_THAT([&] { check_purpose(map, required); },
              ThrowsMessage<IntegrityError>(HasSubstr("expired at 2026-06-01T00:00:00Z")));
  required.now = at("1970-01-01T00:03:00Z");  // a clock that has just been switched on
  EXPECT_THAT([&] { check_purpose(map, required); }, ThrowsMessage<IntegrityError>(HasSubstr("set the clock")));
}

TEST_F(MapPurposeTest, RefusesAnotherCamera) {
  const Camera camera{640, 480, 600, 600, 320, 240};
  std::vector<MapInfoEntry> entries;
  for (const auto& [key, value] : camera_to_text(camera)) entries.push_back({"camera." + key, value});
  const MapReader map = map_with(entries);
  MapRequirements required;
  required.camera = resized_camera(camera, 320, 240);
  check_purpose(map, required);
  required.camera->mount.pitch_deg = 10;
  EXPECT_THAT([&] { check_purpose(map, required); },
              ThrowsMessage<IntegrityError>(HasSubstr("looks up to 10.0° elsewhere than the one that is given")));
  required.camera = Camera{480, 640, 600, 600, 240, 320};
  EXPECT_THAT([&] { check_purpose(map, required); }, ThrowsMessage<IntegrityError>(HasSubstr("has another shape")));
  check_purpose(map_with({}), required);
}

}  // namespace
}  // namespace pilotage
