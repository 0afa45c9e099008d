#include "pilotage/survey/run_survey.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "matchability/known_level.h"
#include "testing/error_of.h"
#include "testing/json_schema.h"
#include "testing/temporary_folder.h"
#include "tile/small_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/progress.h"
#include "pilotage/base/read_file.h"
#include "pilotage/mission/landmark_file.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

// The imagery of the small mission, 600 m by 400 m: nothing else of it.
std::string small_area(const fs::path& folder) {
  return testing::make_small_mission(folder, testing::two_legs()).imagery.front();
}

SurveyOptions small_survey() {
  SurveyOptions options;
  options.camera.hfov_deg = 60;
  options.camera.width_px = 640;
  options.camera.height_px = 480;
  options.agl_m = 80;
  options.search_radius_m = 20;
  options.score.degraded_copies = 1;
  return options;
}

SurveyRun survey_into(const fs::path& folder, int threads = 1) {
  SurveyRun run;
  run.output_folder = folder;
  run.threads = threads;
  return run;
}

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

TEST(RunSurvey, WritesAllFilesAndNothingElse) {
  const testing::TemporaryFolder folder;
  const SurveyResult result = run_survey({small_area(folder.path())}, small_survey(), survey_into(folder / "out"));
  EXPECT_EQ(files_in(folder / "out"), std::set<std::string>(result.files.begin(), result.files.end()));
  EXPECT_EQ(files_in(folder / "out"),
            (std::set<std::string>{"survey.gpkg", "survey.html", "survey.json", "survey.kmz", "survey_classes.qml",
                                   "survey_classes.tif", "survey_classes.tif.aux.xml", "survey_scores.qml",
                                   "survey_scores.tif", "survey_squares.csv", "survey_tiles.csv"}));
  EXPECT_THAT(result.headline, ::testing::StartsWith("a fix may be expected over "));
  EXPECT_NEAR(result.go_share + result.marginal_share + result.no_go_share, 1, 1e-12);
  const auto json = nlohmann::ordered_json::parse(read_file(folder / "out/survey.json"));
  EXPECT_EQ(testing::schema_violation("survey.schema.json", json), "");
  EXPECT_EQ(json["tiles"]["rows"].size(), static_cast<std::size_t>(result.tiles));
}

TEST(RunSurvey, SameBytesForAnyNumberOfThreads) {
  const testing::TemporaryFolder folder;
  const std::string ortho = small_area(folder.path());
  cv::setNumThreads(1);
  const SurveyResult expected = run_survey({ortho}, small_survey(), survey_into(folder / "one"));
  cv::setNumThreads(2);
  const SurveyResult result = run_survey({ortho}, small_survey(), survey_into(folder / "many", 3));
  cv::setNumThreads(-1);
  ASSERT_EQ(result.files, expected.files);
  for (const std::string& name : result.files) {
    EXPECT_EQ(read_file(folder / ("many/" + name)), read_file(folder / ("one/" + name))) << name;
  }
}

// Half of the raster is no data. What nobody photographed is neither go nor no-go: it is no part of the area.
TEST(RunSurvey, GroundWithoutImageryIsNoPartOfTheArea) {
  const testing::TemporaryFolder folder;
  const std::string ortho = small_area(folder.path());
  SurveyOptions options = small_survey();
  options.score.model = testing::model_of_known_level(folder.path());
  const SurveyResult whole = run_survey({ortho}, options, survey_into(folder / "whole"));
  ASSERT_GT(whole.go_share, 0.3);
  testing::change_raster(ortho, [](GDALDataset& dataset) {
    std::vector<std::uint8_t> zeros(std::size_t{300} * 400, 0);
    ASSERT_EQ(
        dataset.GetRasterBand(1)->RasterIO(GF_Write, 300, 0, 300, 400, zeros.data(), 300, 400, GDT_Byte, 0, 0, nullptr),
        CE_None);
    ASSERT_EQ(dataset.GetRasterBand(1)->SetNoDataValue(0), CE_None);
  });
  const SurveyResult half = run_survey({ortho}, options, survey_into(folder / "half"));
  EXPECT_LT(half.area_km2, 0.65 * whole.area_km2);
  EXPECT_GT(half.area_km2, 0.45 * whole.area_km2);
  EXPECT_GT(half.go_share, 0.6 * whole.go_share);
  EXPECT_THAT(read_file((folder / "half" / "survey_tiles.csv").string()),
              ::testing::Not(::testing::HasSubstr(",too_little_ground,,")));
  EXPECT_THAT(read_file((folder / "half" / "survey.json").string()),
              ::testing::HasSubstr("with ground in less than 50 % of each"));
  EXPECT_THAT(read_file((folder / "whole" / "survey.json").string()),
              ::testing::Not(::testing::HasSubstr("with ground in less than")));
}

TEST(RunSurvey, SaysWhereTheElevationModelEnds) {
  const testing::TemporaryFolder folder;
  SurveyOptions options = small_survey();
  testing::RasterSpec heights;
  heights.width = 30;
  heights.height = 80;
  heights.type = GDT_Float32;
  heights.place = GeoTransform::north_up(499'800, 5'000'200, 10);  // of the area's western half
  options.elevation = testing::make_raster(folder / "dem.tif", heights);
  const SurveyResult result = run_survey({small_area(folder.path())}, options, survey_into(folder / "out"));
  EXPECT_THAT(
      result.warnings,
      ::testing::Contains(::testing::ContainsRegex("dem.tif: gives no heights for [1-9][0-9]* of [0-9]+ tiles")));
}

TEST(RunSurvey, RefusesExistingOutputsBeforeAnyWork) {
  for (const char* name : {"survey.html", "survey.json", "survey_squares.csv", "survey_classes.tif.aux.xml"}) {
    const testing::TemporaryFolder folder;
    write_file(folder / name, "mine", false);
    try {
      run_survey({"missing.tif"}, small_survey(), survey_into(folder.path()));
      ADD_FAILURE() << name;
    } catch (const DataError& error) {
      EXPECT_EQ(std::string(error.what()),
                (folder / name).string() + ": exists already; give --overwrite to replace it");
    }
    EXPECT_EQ(read_file(folder / name), "mine");
  }
}

TEST(RunSurvey, LeavesNothingWhenItIsInterrupted) {
  const testing::TemporaryFolder folder;
  const std::string ortho = small_area(folder.path());
  int calls = 0;
  const Progress stop = [&](std::string_view, std::int64_t, std::int64_t) { return ++calls < 20; };
  EXPECT_THROW(run_survey({ortho}, small_survey(), survey_into(folder / "out"), stop), Interrupted);
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(RunSurvey, LandmarksAreALayerAndAColumnOfTheirOwn) {
  const testing::TemporaryFolder folder;
  const std::string ortho = small_area(folder.path());
  const SurveyResult plain = run_survey({ortho}, small_survey(), survey_into(folder / "plain"));
  const auto places = nlohmann::ordered_json::parse(read_file(folder / "plain/survey.json"))["tiles"];
  const auto column = [&](const char* name) {
    const auto& names = places["columns"];
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  MapLandmarks landmarks;
  MapDetector detector;
  detector.detector.class_name = "ring";
  detector.detector.gsd_m = 0.5;
  detector.detector.context = 1.3;
  detector.detector.shortest_m = detector.detector.longest_m = 10;
  detector.detector.filters = {std::vector<float>(detector.detector.window.filter_size(), 0.5F)};
  detector.p_detect = 0.9;
  detector.sigma_m = 0.3;
  landmarks.detectors.push_back(detector);
  const auto& row = places["rows"][0];
  landmarks.landmarks.push_back(
      {0,
       0,
       {row[column("center_lon_deg")].get<double>(), row[column("center_lat_deg")].get<double>()},
       10,
       kNaN,
       true,
       0});
  SurveyOptions options = small_survey();
  options.landmarks = (folder / "landmarks.json").string();
  write_file(options.landmarks, json_text(map_landmarks_to_json(landmarks), 0), true);
  const SurveyResult result = run_survey({ortho}, options, survey_into(folder / "out"));
  EXPECT_EQ(plain.landmarks, "");
  EXPECT_THAT(result.landmarks, ::testing::StartsWith("1 landmark of 1 class (ring): nowhere"));
  const auto json = nlohmann::ordered_json::parse(read_file(folder / "out/survey.json"));
  EXPECT_EQ(testing::schema_violation("survey.schema.json", json), "");
  EXPECT_EQ(json["inputs"].back()["role"], "landmarks");
  EXPECT_THAT(read_file(folder / "out/survey.gpkg"), ::testing::HasSubstr("p_landmark_fix"));
  EXPECT_THAT(read_file(folder / "plain/survey.gpkg"), ::testing::Not(::testing::HasSubstr("p_landmark_fix")));

  landmarks.landmarks.front().place.lat_deg = 0;
  write_file(options.landmarks, json_text(map_landmarks_to_json(landmarks), 0), true);
  EXPECT_THAT(testing::error_of<DataError>([&] { run_survey({ortho}, options, survey_into(folder / "none")); }),
              ::testing::HasSubstr("none of its landmarks lies on the ground of a tile"));
  EXPECT_FALSE(fs::exists(folder / "none"));
}

}  // namespace
}  // namespace pilotage
