#include "pilotage/flightlog/match_flight.h"

#include <atomic>
#include <cmath>

#include "mapdb/small_map.h"
#include "testing/pinhole_camera.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/flightlog/fix_table.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

/// A small map and frames beside it: good ones, one that is no picture, one of another shape.
class LoggedFlight {
 public:
  LoggedFlight() {
    const testing::SmallMap map = testing::make_small_map();
    testing::write_map(map_path(), map);
    for (int i = 0; i < 12; ++i) {
      cv::Mat pixels(60, 80, CV_8U);
      cv::randu(pixels, 0, 255);
      add(std::to_string(i) + ".png", pixels, map.tiles.front().center, i);
    }
    add("tall.png", cv::Mat(80, 60, CV_8U, cv::Scalar(100)), map.tiles.front().center, 12);
    write_file(folder_ / "text.png", "no picture", false);
    frames_.push_back(frames_.front());
    frames_.back().path = (folder_ / "text.png").string();
    frames_.back().frame.file = "text.png";
  }

  std::filesystem::path map_path() const { return folder_ / "map.gpkg"; }
  OpenMaps open_maps() const { return open_unverified_maps({map_path()}); }
  const std::vector<FlightFrame>& frames() const { return frames_; }
  std::vector<FrameMatch> match(int threads, const Progress& progress = {}) const {
    return match_flight(open_maps(), frames_, {}, threads, progress);
  }

 private:
  void add(const std::string& name, const cv::Mat& pixels, GeodeticPoint place, int i) {
    const std::string path = (folder_ / name).string();
    cv::imwrite(path, pixels);
    frames_.push_back({path,
                       {name, 1.0 * i, place, isotropic_covariance_m2(10), 50, {10.0 * i, 0, 0}, place, {}},
                       testing::pinhole_camera(80, 60, 80)});
  }

  TemporaryFolder folder_;
  std::vector<FlightFrame> frames_;
};

TEST(MatchFlight, AnswersInOrderWhateverTheThreads) {
  const LoggedFlight flight;
  const std::vector<FrameMatch> one = flight.match(1);
  ASSERT_EQ(one.size(), flight.frames().size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].frame.file, flight.frames()[i].frame.file);
  EXPECT_EQ(fix_table_to_csv(flight.match(4), false), fix_table_to_csv(one, false));
}

TEST(MatchFlight, WhatCannotBeMatchedIsARowOfItsOwn) {
  const LoggedFlight flight;
  const std::vector<FrameMatch> matches = flight.match(2);
  EXPECT_TRUE(matches[0].readable());
  EXPECT_FALSE(std::isnan(matches[0].milliseconds));
  const FrameMatch& tall = matches[12];
  EXPECT_EQ(frame_status_name(tall), "unreadable");
  EXPECT_THAT(tall.problem, HasSubstr("tall.png: has 60 x 80 px, the camera 80 x 60 px: another shape"));
  EXPECT_THAT(matches[13].problem, HasSubstr("text.png: cannot be opened as a raster"));
  EXPECT_TRUE(std::isnan(matches[13].milliseconds));
}

// The shape is told before a pixel is read: of this file there are none.
TEST(MatchFlight, TheShapeAndTheMemoryCountBeforeAPictureIsRead) {
  const LoggedFlight flight;
  const TemporaryFolder folder;
  std::vector<FlightFrame> frames(2, flight.frames().front());
  const auto cut = [&](FlightFrame& frame, const char* name, cv::Size size) {
    frame.path = (folder / name).string();
    cv::imwrite(frame.path, cv::Mat(size, CV_8U, cv::Scalar(0)));
    std::filesystem::resize_file(frame.path, 60);
  };
  cut(frames[0], "other.png", {3000, 3000});
  cut(frames[1], "large.png", {12000, 9000});
  frames.push_back(flight.frames().front());
  const std::vector<FrameMatch> matches = match_flight(flight.open_maps(), frames, {}, 1, {});
  EXPECT_THAT(matches[0].problem, HasSubstr("other.png: has 3000 x 3000 px, the camera 80 x 60 px: another shape"));
  EXPECT_EQ(frame_status_name(matches[1]), "too_uncertain") << matches[1].problem;
}

TEST(MatchFlight, NotOneReadableFrameIsAnError) {
  const LoggedFlight flight;
  const std::vector<FlightFrame> bad(flight.frames().end() - 2, flight.frames().end());
  try {
    match_flight(flight.open_maps(), bad, {}, 1, {});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("not one of 2 frames can be read; the first: "));
    EXPECT_THAT(error.what(), HasSubstr("tall.png: has 60 x 80 px"));
  }
  EXPECT_THROW(match_flight(open_unverified_maps({flight.map_path() / "x"}), flight.frames(), {}, 2, {}), DataError);
}

TEST(MatchFlight, ProgressCountsFramesAndMayStop) {
  const LoggedFlight flight;
  std::int64_t last = -1;
  int calls = 0;
  flight.match(3, [&](std::string_view, std::int64_t done, std::int64_t total) {
    EXPECT_TRUE(done == last || done == last + 1) << done;
    EXPECT_EQ(total, 14);
    ++calls;
    last = done;
    return true;
  });
  EXPECT_EQ(last, 14);
  EXPECT_GT(calls, 15 + 14) << "asked within a frame, too";
  EXPECT_THROW(flight.match(3, [](std::string_view, std::int64_t done, std::int64_t) { return done < 5; }),
               Interrupted);
}

TEST(ErrorOfFix, IsTheWayFromTheTruthInTheAnswersOwnUnits) {
  const GeodeticPoint truth{16.5, 55.5};
  Fix fix;
  fix.position = geodesic_direct(truth, 90, 3);  // 3 m east
  fix.covariance_en_m2 << 9, 0, 0, 1;
  fix.center = geodesic_direct(truth, 180, 4);  // 4 m south
  fix.center_covariance_en_m2 << 1, 0, 0, 4;
  const FixError nadir = error_of_fix(fix, truth, FrameTruth::kNadir);
  EXPECT_NEAR(nadir.east_m, 3, 1e-6);
  EXPECT_NEAR(nadir.north_m, 0, 1e-5);
  EXPECT_NEAR(nadir.error_m, 3, 1e-6);
  EXPECT_NEAR(nadir.nees, 1, 1e-5);
  const FixError center = error_of_fix(fix, truth, FrameTruth::kCenter);
  EXPECT_NEAR(center.east_m, 0, 1e-5);
  EXPECT_NEAR(center.north_m, -4, 1e-6);
  EXPECT_NEAR(center.nees, 4, 1e-5);
}

TEST(ErrorOfFix, NeesHeedsTheCorrelation) {
  const GeodeticPoint truth{16.5, 55.5};
  Fix fix;
  fix.position = LocalFrame(truth).geodetic_from_enu({2, 2, 0});
  fix.covariance_en_m2 << 5, 3, 3, 5;  // eigenvalues 8 along (1, 1) and 2 across: 8 / 8
  EXPECT_NEAR(error_of_fix(fix, truth, FrameTruth::kNadir).nees, 1, 1e-6);
  fix.position = LocalFrame(truth).geodetic_from_enu({2, -2, 0});
  EXPECT_NEAR(error_of_fix(fix, truth, FrameTruth::kNadir).nees, 4, 1e-6);
  fix.covariance_en_m2.setZero();
  EXPECT_TRUE(std::isnan(error_of_fix(fix, truth, FrameTruth::kNadir).nees));
}

// A disk that fails is no property of a frame: as a refusal it would stand in a rate that somebody flies by. Nor is it
// where another map has a fix.
TEST(RequireFrameWasTried, TellsWhatIsNotOfTheFrame) {
  const std::vector<std::string> maps{"m.gpkg", "older.gpkg"};
  for (int number = 0; number <= static_cast<int>(MatchStatus::kOutOfMemory); ++number) {
    const auto status = static_cast<MatchStatus>(number);
    MatchResult result;
    result.map_statuses = {MatchStatus::kFix, status};
    if (status == MatchStatus::kMapUnreadable) {
      EXPECT_THAT([&] { require_frame_was_tried(result, maps); },
                  ::testing::ThrowsMessage<DataError>(HasSubstr("older.gpkg: a part of it cannot be read")));
    } else if (status == MatchStatus::kOutOfMemory) {
      EXPECT_THROW(require_frame_was_tried(result, maps), std::bad_alloc);
    } else {
      EXPECT_NO_THROW(require_frame_was_tried(result, maps));
    }
  }
}

}  // namespace
}  // namespace pilotage
