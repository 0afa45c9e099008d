#include "pilotage/base/config_file.h"

#include <fstream>

#include "cli/toy_command.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

TEST(ConfigFile, OnlyFilesBesideItAreResolved) {
  const testing::TemporaryFolder folder;
  write_file(folder / "ortho.tif", "", false);
  EXPECT_EQ(path_beside("ortho.tif", folder.path()), (folder / "ortho.tif").string());
  EXPECT_EQ(path_beside("./ortho.tif", folder.path()), (folder / "ortho.tif").string());
  for (const char* untouched : {"other.tif", "/vsicurl/https://example.org/a.tif", "/absolute/ortho.tif",
                                "NETCDF:ortho.tif:band", "WMS:http://example.org/", ""}) {
    EXPECT_EQ(path_beside(untouched, folder.path()), untouched);
  }
}

TEST(ConfigFile, ResolvesPathFieldsAndNothingElse) {
  const testing::TemporaryFolder folder;
  write_file(folder / "ortho.tif", "", false);
  write_file(folder / "mission.json",
             R"({"name": "ortho.tif", "imagery": ["ortho.tif", "/vsimem/x"], "elevation": "ortho.tif",
                 "camera": {"hfov_deg": 45}})",
             false);
  ToyOptions options;
  load_config_file(list_options(options), folder / "mission.json");
  EXPECT_EQ(options.name, "ortho.tif");
  EXPECT_THAT(options.imagery, ::testing::ElementsAre((folder / "ortho.tif").string(), "/vsimem/x"));
  EXPECT_EQ(options.elevation, (folder / "ortho.tif").string());
  EXPECT_EQ(options.camera.hfov_deg, 45);
}

TEST(ConfigFile, WrongTypesOfPathsAreErrors) {
  const testing::TemporaryFolder folder;
  for (const char* json : {R"({"imagery": [3]})", R"({"imagery": {"a": 1}})", R"({"elevation": ["a"]})", R"([])"}) {
    write_file(folder / "mission.json", json, true);
    ToyOptions options;
    EXPECT_THROW(load_config_file(list_options(options), folder / "mission.json"), UsageError) << json;
  }
  ToyOptions options;
  EXPECT_THROW(load_config_file(list_options(options), folder / "absent.json"), DataError);
}

}  // namespace
}  // namespace pilotage
