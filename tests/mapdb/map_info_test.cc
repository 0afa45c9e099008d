#include "pilotage/mapdb/map_info.h"

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/camera/camera_text.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Camera some_camera() {
  Camera camera{640, 480, 600, 610, 320, 240.5};
  camera.mount.pitch_deg = 3;
  return camera;
}

FeatureOptions some_features() {
  FeatureOptions options;
  options.pattern = DescriptorPattern::kBrief;
  options.descriptor_bits = 512;
  options.features_per_mpx = 12345.5;
  options.octaves = 3;
  return options;
}

std::vector<MapInfoEntry> camera_entries() {
  std::vector<MapInfoEntry> entries;
  for (const auto& [key, value] : camera_to_text(some_camera())) entries.push_back({"camera." + key, value});
  return entries;
}

std::vector<MapInfoEntry> feature_entries() {
  std::vector<MapInfoEntry> entries;
  FeatureOptions options = some_features();
  for (const OptionField& field : list_options(options).fields) {
    entries.push_back({"features." + field.path, option_to_text(field.get())});
  }
  return entries;
}

/// The entries with the value of a key replaced.
std::vector<MapInfoEntry> changed(std::vector<MapInfoEntry> entries, const std::string& key, const std::string& value) {
  for (MapInfoEntry& entry : entries) {
    if (entry.key == key) entry.value = value;
  }
  return entries;
}

MapInfo info_of(std::vector<MapInfoEntry> entries) {
  MapInfo info;
  info.entries = std::move(entries);
  return info;
}

TEST(MapInfo, GivesBackTheCameraThatWasWritten) {
  EXPECT_FALSE(camera_of_info(info_of({{"schema_version", "1"}, {"camera", "{}"}}), "map.gpkg"));
  EXPECT_EQ(camera_of_info(info_of(camera_entries()), "map.gpkg"), some_camera());
}

TEST(MapInfo, RefusesACameraWhoseNumbersAreNone) {
  for (const char* value : {"nan", "inf", "-inf"}) {
    EXPECT_THAT([&] { camera_of_info(info_of(changed(camera_entries(), "camera.fx_px", value)), "map.gpkg"); },
                ThrowsMessage<DataError>(HasSubstr("map.gpkg: map_info: camera: fx_px = \"" + std::string(value))));
    EXPECT_THROW(camera_of_info(info_of(changed(camera_entries(), "camera.mount_yaw_deg", value)), "map.gpkg"),
                 DataError);
  }
}

TEST(MapInfo, GivesBackTheFeatureOptionsThatWereWritten) {
  const FeatureOptions read = features_of_info(info_of(feature_entries()), "map.gpkg");
  EXPECT_EQ(read.descriptor_bits, 512);
  EXPECT_EQ(read.pattern, DescriptorPattern::kBrief);
  EXPECT_EQ(read.features_per_mpx, 12345.5);
  EXPECT_EQ(read.octaves, 3);
  EXPECT_EQ(read.scale_factor, FeatureOptions().scale_factor);
  const FeatureOptions none = features_of_info(info_of({{"schema_version", "1"}}), "map.gpkg");
  EXPECT_EQ(none.descriptor_bits, kDefaultDescriptorBits);
  EXPECT_EQ(none.pattern, kDefaultDescriptorPattern);
}

TEST(MapInfo, SaysHowGoodItsHeightsAre) {
  EXPECT_EQ(elevation_sigma_m_of_info(info_of({{"elevation_sigma_m", "2.5"}}), "map.gpkg"), 2.5);
  EXPECT_EQ(elevation_sigma_m_of_info(info_of({{"schema_version", "1"}}), "map.gpkg"), std::nullopt);
  for (const char* bad : {"", "x", "-1", "101", "nan", "1e400"}) {
    EXPECT_THAT(
        [&] {
          elevation_sigma_m_of_info(info_of({{"elevation_sigma_m", bad}}), "map.gpkg");
        },
        ThrowsMessage<DataError>(HasSubstr("map.gpkg: map_info: elevation_sigma_m = \"" + std::string(bad))));
  }
}

TEST(MapInfo, RefusesDamagedFeatureOptions) {
  const auto expect = [](std::vector<MapInfoEntry> entries, const std::string& message) {
    EXPECT_THAT([&] { features_of_info(info_of(entries), "map.gpkg"); },
                ThrowsMessage<DataError>(HasSubstr("map.gpkg: map_info: features: " + message)));
  };
  const auto good = feature_entries();
  // What std::atoi took for 256, 0 and 512.
  expect(changed(good, "features.descriptor_bits", "256x"), "descriptor_bits = \"256x\" is not an integer");
  expect(changed(good, "features.descriptor_bits", ""), "descriptor_bits = \"\" is not an integer");
  expect(changed(good, "features.descriptor_bits", "512.5"), "descriptor_bits = \"512.5\" is not an integer");
  expect(changed(good, "features.descriptor_bits", "200"),
         "descriptor_bits = 200 of the pattern brief is not one of: 128, 512");
  expect(changed(good, "features.descriptor_bits", "1024"), "descriptor_bits = 1024 is outside [64, 512]");
  expect(changed(good, "features.pattern", "sift"), "pattern = \"sift\" is not one of: ground, orb, brief");
  expect(changed(good, "features.pattern", "orb"), "descriptor_bits = 512 of the pattern orb is not one of: 256");
  expect(changed(good, "features.min_fast_threshold", "30"), "min_fast_threshold = 30 is above");
  auto entries = good;
  entries.push_back({"features.colour", "true"});
  expect(entries, "unknown key \"colour\"");
  entries = good;
  entries.push_back(good.front());
  expect(entries, "duplicate key \"features_per_mpx\"");
  entries = good;
  entries.erase(entries.begin() + 2);
  expect(entries, "\"descriptor_bits\" is missing");
}

TEST(MapInfo, RefusesTestsThatItDoesNotHave) {
  auto entries = changed(changed(feature_entries(), "features.pattern", "ground"), "features.descriptor_bits", "128");
  entries.push_back({"pattern_digest", pattern_digest(DescriptorPattern::kGround)});
  EXPECT_EQ(features_of_info(info_of(entries), "map.gpkg").pattern, DescriptorPattern::kGround);
  EXPECT_THAT([&] { features_of_info(info_of(changed(entries, "pattern_digest", std::string(64, '0'))), "map.gpkg"); },
              ThrowsMessage<DataError>(HasSubstr("map.gpkg: map_info: its descriptors are of other tests than")));
  EXPECT_EQ(pattern_digest(DescriptorPattern::kOrb), "") << "its name says all";
}

// Both are read when the map is opened, and a damaged value says so then, with the name of the file.
TEST(MapInfo, IsReadOnceWhenTheMapIsOpened) {
  const testing::TemporaryFolder folder;
  const auto write = [&](const std::vector<MapInfoEntry>& camera, const std::vector<MapInfoEntry>& features) {
    testing::SmallMap map = testing::make_small_map();
    map.info.insert(map.info.end(), camera.begin(), camera.end());
    map.info.insert(map.info.end(), features.begin(), features.end());
    testing::write_map(folder / "map.gpkg", map, true);
    return folder / "map.gpkg";
  };
  const MapReader reader = MapReader::open_unverified(write(camera_entries(), feature_entries()));
  EXPECT_EQ(reader.camera(), some_camera());
  EXPECT_EQ(reader.features().descriptor_bits, 512);
  EXPECT_FALSE(MapReader::open_unverified(write({}, {})).camera());
  EXPECT_THAT([&] { MapReader::open_unverified(write(changed(camera_entries(), "camera.fx_px", "x"), {})); },
              ThrowsMessage<DataError>(HasSubstr("map.gpkg: map_info: camera: fx_px = \"x\" is not a number")));
  EXPECT_THAT([&] { MapReader::open_unverified(write({}, changed(feature_entries(), "features.octaves", "0"))); },
              ThrowsMessage<DataError>(HasSubstr("map.gpkg: map_info: features: octaves = 0 is outside")));
}

}  // namespace
}  // namespace pilotage
