#include "pilotage/match/heading_ranking.h"

#include <cmath>

#include "match/shot.h"
#include <gtest/gtest.h>

#include "pilotage/base/angle.h"
#include "pilotage/match/frame_grid.h"

namespace pilotage {
namespace {

using testing::Shot;
using testing::ShotMap;

const ShotMap& ranked_map() {
  static const ShotMap kMap(testing::make_textured_ground());
  return kMap;
}

MatchOptions about_a_heading() {
  MatchOptions options;
  options.yaw_sigma_deg = 2.5;
  return options;
}

std::vector<double> all_around_deg() {
  std::vector<double> headings_deg;
  for (int heading_deg = 0; heading_deg < 360; heading_deg += 10) headings_deg.push_back(heading_deg);
  return headings_deg;
}

std::vector<double> ranked_deg(const ShotMap& map, const Shot& shot, std::size_t count) {
  const cv::Mat frame = testing::frame_over(map.ground, shot.east_m, shot.north_m, shot.attitude, shot.height_m).gray;
  MapReader reader = MapReader::open_unverified(map.path);
  return promising_headings_deg(frame, prior_of(map, shot), map.ground.camera, reader, about_a_heading(),
                                all_around_deg(), count);
}

TEST(TurnedFrame, IsTheFrameRectifiedAtThatHeading) {
  Shot shot;
  shot.attitude = {25, 8, -5};
  const cv::Mat frame =
      testing::frame_over(ranked_map().ground, shot.east_m, shot.north_m, shot.attitude, shot.height_m).gray;
  MapReader reader = MapReader::open_unverified(ranked_map().path);
  const auto rectified_at = [&](double yaw_deg) {
    MatchPrior prior = prior_of(ranked_map(), shot);
    prior.attitude.yaw_deg = yaw_deg;
    return rectify_frame(frame, prior, ranked_map().ground.camera, reader, {});
  };
  FrameOnGrid first = rectified_at(25);
  first.frame = continued_frame(first.frame, {});
  for (const double turn_deg : {0.0, 40.0, 145.0, -80.0}) {
    const FrameOnGrid direct = rectified_at(25 + turn_deg);
    const FrameOnGrid turned = turned_frame(first, turn_deg * kRadPerDeg);
    EXPECT_LT((turned.pivot_m - direct.pivot_m).norm(), 1e-9);
    // Where both are valid they show the same, and better so than a pixel beside.
    const auto difference = [&](const Eigen::Vector2d& off_px) {
      double sum = 0;
      int count = 0;
      for (int y = 0; y < direct.frame.gray.rows; ++y) {
        for (int x = 0; x < direct.frame.gray.cols; ++x) {
          const Eigen::Vector2d place =
              turned.frame.pixel_from_ground(direct.frame.ground_from_pixel({x + 0.5, y + 0.5}));
          const Eigen::Vector2i at = (place + off_px).array().floor().cast<int>();
          const bool shown = at.minCoeff() >= 0 && at.x() < turned.frame.gray.cols && at.y() < turned.frame.gray.rows;
          if (!shown || direct.frame.valid.at<std::uint8_t>(y, x) == 0) continue;
          if (turned.frame.valid.at<std::uint8_t>(at.y(), at.x()) == 0) continue;
          sum +=
              std::abs(direct.frame.gray.at<std::uint8_t>(y, x) - turned.frame.gray.at<std::uint8_t>(at.y(), at.x()));
          ++count;
        }
      }
      EXPECT_GT(count, 0.9 * cv::countNonZero(direct.frame.valid));
      return sum / count;
    };
    const double here = difference({0, 0});
    for (const Eigen::Vector2d& off_px :
         {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)}) {
      EXPECT_LT(here, 0.7 * difference(off_px)) << turn_deg << ": " << off_px.transpose();
    }
  }
}

TEST(HeadingRanking, TheNearestHeadingIsAmongTheFirst) {
  for (const double heading_deg : {3.0, 15.0, 96.0, 140.0, 201.0, 265.0, 334.0}) {
    Shot shot;
    shot.attitude = {heading_deg, 2, -1};
    const std::vector<double> first_deg = ranked_deg(ranked_map(), shot, 3);
    ASSERT_EQ(first_deg.size(), 3U);
    EXPECT_LE(std::abs(std::remainder(first_deg.front() - heading_deg, 360)), 10) << heading_deg;
  }
}

TEST(HeadingRanking, WhereNothingIsSeenTheFirstOnesStay) {
  Shot shot;
  shot.prior_off_m = {3000, 0};  // no tile there
  EXPECT_EQ(ranked_deg(ranked_map(), shot, 4), (std::vector<double>{0, 10, 20, 30}));
  const cv::Mat blank(ranked_map().ground.camera.height_px, ranked_map().ground.camera.width_px, CV_8UC1,
                      cv::Scalar(90));
  MapReader reader = MapReader::open_unverified(ranked_map().path);
  MatchOptions options = about_a_heading();
  options.max_memory_mib = 1e-3;  // room for nothing
  EXPECT_EQ(promising_headings_deg(blank, prior_of(ranked_map(), {}), ranked_map().ground.camera, reader, options,
                                   {40, 50, 60}, 2),
            (std::vector<double>{40, 50}));
}

TEST(HeadingRanking, FewHeadingsAreAllKept) {
  const cv::Mat frame = testing::frame_over(ranked_map().ground, 0, 0, {20, 0, 0}, 60).gray;
  MapReader reader = MapReader::open_unverified(ranked_map().path);
  Shot shot;
  shot.attitude.yaw_deg = 20;
  EXPECT_EQ(promising_headings_deg(frame, prior_of(ranked_map(), shot), ranked_map().ground.camera, reader,
                                   about_a_heading(), {200, 20}, 5),
            (std::vector<double>{20, 200}));
}

TEST(HeadingRanking, AStoppedSearchEnds) {
  const cv::Mat frame = testing::frame_over(ranked_map().ground, 0, 0, {}, 60).gray;
  MapReader reader = MapReader::open_unverified(ranked_map().path);
  struct Stopped {};
  int looked_at = 0;
  EXPECT_THROW(promising_headings_deg(frame, prior_of(ranked_map(), {}), ranked_map().ground.camera, reader,
                                      about_a_heading(), all_around_deg(), 3,
                                      [&] {
                                        if (++looked_at == 20) throw Stopped{};
                                      }),
               Stopped);
}

}  // namespace
}  // namespace pilotage
