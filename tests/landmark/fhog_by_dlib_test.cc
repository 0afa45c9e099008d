// The scorer that flies, against dlib, whose filters it lays over pictures.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "landmark/dlib_detector.h"
#include "landmark/landmark_ground.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/landmark/fhog_training.h"
#include "pilotage/vision/landmark_detector.h"

namespace pilotage {
namespace {

using testing::detect_by_dlib;
using testing::DlibHit;

/// Discs and squares in noise, a strip of flat ground, black and white beside each other.
cv::Mat busy_picture(int width_px, int height_px, std::uint64_t seed) {
  const int side_px = std::max(width_px, height_px);
  cv::Mat gray =
      testing::draw_ground(testing::scattered(6, 6, true, seed), side_px, 75, seed)(cv::Rect(0, 0, width_px, height_px))
          .clone();
  cv::rectangle(gray, {5, 5, 40, 30}, cv::Scalar(0), cv::FILLED);
  cv::rectangle(gray, {45, 5, 40, 30}, cv::Scalar(255), cv::FILLED);
  cv::rectangle(gray, {90, 5, 60, 60}, cv::Scalar(128), cv::FILLED);
  return gray;
}

double largest_difference(const FhogCells& cells, const std::vector<cv::Mat>& by_dlib) {
  double largest = 0;
  for (int plane = 0; plane < kFhogPlanes; ++plane) {
    const cv::Mat& other = by_dlib[static_cast<std::size_t>(plane)];
    EXPECT_EQ(other.rows, cells.rows());
    EXPECT_EQ(other.cols, cells.cols());
    for (int row = 0; row < cells.rows(); ++row) {
      for (int col = 0; col < cells.cols(); ++col) {
        largest =
            std::max(largest, static_cast<double>(std::abs(cells.row(plane, row)[col] - other.at<float>(row, col))));
      }
    }
  }
  return largest;
}

TEST(FhogByDlib, CellsAreDlibs) {
  for (const auto& [width_px, height_px, cell_px] :
       {std::array{200, 150, 5}, std::array{203, 151, 8}, std::array{64, 47, 4}, std::array{97, 188, 6},
        std::array{34, 33, 11}}) {
    const cv::Mat gray = busy_picture(width_px, height_px, 3);
    const FhogCells cells(gray, cell_px, 3);
    EXPECT_LT(largest_difference(cells, testing::fhog_by_dlib(gray, cell_px)), 2e-6)
        << width_px << " x " << height_px << ", cells of " << cell_px;
  }
}

TEST(FhogByDlib, TheMarginIsZeroAndSmallPicturesHaveNoCells) {
  const FhogCells cells(busy_picture(203, 151, 5), 8, 4);
  for (int plane = 0; plane < kFhogPlanes; ++plane) {
    for (int row = -4; row < cells.rows() + 4; ++row) {
      const bool beside = row < 0 || row >= cells.rows();
      for (int col = -4; col < cells.cols() + 4 + kFhogTile; ++col) {
        if (!beside && col >= 0 && col < cells.cols()) continue;
        ASSERT_EQ(cells.row(plane, row)[col], 0) << plane << ", " << row << ", " << col;
      }
    }
  }
  EXPECT_EQ(FhogCells(cv::Mat(200, 11, CV_8UC1, cv::Scalar(3)), 5, 1).rows(), 0);
  EXPECT_EQ(FhogCells(cv::Mat(), 5, 1).cols(), 0);
}

TEST(FhogByDlib, SmallerPicturesAreDlibs) {
  for (const auto& [width_px, height_px] : {std::array{200, 150}, std::array{203, 151}, std::array{64, 7}}) {
    const cv::Mat gray = busy_picture(200, 200, 9)(cv::Rect(0, 0, std::min(width_px, 200), height_px)).clone();
    const cv::Mat own = fhog_pyramid_down(gray);
    const cv::Mat other = testing::pyramid_down_by_dlib(gray);
    ASSERT_EQ(own.size(), other.size());
    cv::Mat difference;
    cv::absdiff(own, other, difference);
    // dlib cuts off fractions in the last columns of a row, four or so, where it rounds in all others.
    EXPECT_EQ(cv::countNonZero(difference.colRange(0, difference.cols - 5)), 0);
    double most = 0;
    cv::minMaxLoc(difference, nullptr, &most);
    EXPECT_LE(most, 1);
  }
}

/// A filter of discs.
std::vector<float> disc_filter() {
  const std::vector<testing::GroundThing> things = testing::scattered(5, 5, true, 1);
  constexpr int kSide_px = 700;
  constexpr int kCrop_px = 90;
  const cv::Mat ground = testing::draw_ground(things, kSide_px, 75, 1);
  std::vector<TrainingPicture> pictures;
  for (const testing::GroundThing& thing : things) {
    const Eigen::Vector2d corner_px = thing.center_m / testing::kGroundGsd_m - Eigen::Vector2d(kCrop_px, kCrop_px) / 2;
    const cv::Rect crop(static_cast<int>(std::lround(corner_px.x())), static_cast<int>(std::lround(corner_px.y())),
                        kCrop_px, kCrop_px);
    if ((crop & cv::Rect(0, 0, ground.cols, ground.rows)) != crop) continue;
    const int side = static_cast<int>(std::lround(1.3 * thing.length_m / testing::kGroundGsd_m));
    const int corner = (kCrop_px - side) / 2;
    pictures.push_back({ground(crop).clone(), {{corner, corner, side, side}}, {}});
  }
  EXPECT_GE(pictures.size(), 10U);
  return train_fhog(pictures, {45, 5, 2}, {}).weights;
}

/// Compares the hits of both; returns how many.
int expect_the_same_hits(const std::vector<float>& filter, const cv::Mat& gray, double least_score) {
  LandmarkDetector detector;
  detector.class_name = "disc";
  detector.gsd_m = 1;
  detector.window = {45, 5, 4};
  detector.context = 1.3;
  detector.shortest_m = detector.longest_m = 35;
  detector.filters = {filter};
  const std::vector<LandmarkHit> own = detect_landmarks(detector, gray, detector.gsd_m, least_score - 0.1);
  const std::vector<DlibHit> by_dlib = detect_by_dlib(filter, detector.window, gray, least_score);
  int compared = 0;
  for (const DlibHit& hit : by_dlib) {
    // At the right border dlib's smaller pictures are cut off, and boxes beyond the left and the upper one are wider.
    if (hit.center_px.x() + hit.side_px > gray.cols || hit.center_px.minCoeff() < hit.side_px / 2) continue;
    // dlib lets hits stand that cover each other by less than half.
    const bool beside_stronger = std::any_of(by_dlib.begin(), by_dlib.end(), [&](const DlibHit& stronger) {
      const double length_px = std::max(stronger.side_px, hit.side_px) / detector.context;
      return stronger.score > hit.score && (stronger.center_px - hit.center_px).norm() < 1.3 * kSamePlace * length_px;
    });
    if (beside_stronger) continue;
    const auto same = std::find_if(own.begin(), own.end(), [&](const LandmarkHit& one) {
      return (one.center_px - hit.center_px).norm() < 0.1 * hit.side_px + 4 &&
             std::abs(one.length_px * detector.context / hit.side_px - 1) < 0.05;
    });
    EXPECT_NE(same, own.end()) << hit.center_px.transpose() << ", side " << hit.side_px << ", score " << hit.score;
    if (same == own.end()) continue;
    EXPECT_NEAR(same->score, hit.score, 1e-4);
    ++compared;
  }
  return compared;
}

TEST(FhogByDlib, ScoresAreDlibsAndHitsLieAtTheirPlaces) {
  const cv::Mat elsewhere = testing::draw_ground(testing::scattered(5, 5, true, 8), 500, 75, 8);
  EXPECT_GE(expect_the_same_hits(disc_filter(), elsewhere, -0.5), 10);
}

TEST(FhogByDlib, ScoresAreDlibsOnRealChips) {
  const std::filesystem::path data = testing::real_data_folder();
  if (data.empty()) GTEST_SKIP() << testing::kNoRealImagery;
  std::vector<std::filesystem::path> tiles;
  for (const auto& entry : std::filesystem::directory_iterator(data / "landmarks" / "kampala")) {
    if (entry.path().extension() == ".png") tiles.push_back(entry.path());
  }
  std::sort(tiles.begin(), tiles.end());
  ASSERT_GE(tiles.size(), 20U);
  const std::vector<float> filter = disc_filter();
  int compared = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    const cv::Mat tile = cv::imread(tiles[i].string(), cv::IMREAD_GRAYSCALE);
    ASSERT_FALSE(tile.empty()) << tiles[i];
    compared += expect_the_same_hits(filter, tile, -1.5);
  }
  EXPECT_GE(compared, 40);
}

TEST(FhogByDlib, WhatDoesNotFitIsAnError) {
  const FhogCells cells(busy_picture(100, 100, 1), 5, 5);
  EXPECT_THROW(correlate_fhog(cells, std::vector<float>(31 * 11 * 11 - 1), 11), UsageError);
  EXPECT_THROW(correlate_fhog(cells, std::vector<float>(31 * 13 * 13), 13), UsageError);
  EXPECT_THROW(FhogCells(cv::Mat(10, 10, CV_8UC3), 5, 1), UsageError);
  LandmarkDetector detector;
  detector.class_name = "disc";
  detector.gsd_m = 1;
  detector.context = 1;
  detector.shortest_m = detector.longest_m = 35;
  detector.filters = {std::vector<float>(7)};
  EXPECT_THROW(detect_landmarks(detector, busy_picture(100, 100, 1), 1, 0), UsageError);
  detector.filters = {std::vector<float>(detector.window.filter_size())};
  EXPECT_THROW(detect_landmarks(detector, busy_picture(100, 100, 1), kNaN, 0), UsageError);
  EXPECT_TRUE(detect_landmarks(detector, cv::Mat(), 1, 0).empty());
  EXPECT_TRUE(detect_landmarks(detector, busy_picture(100, 100, 1), 0.001, 0).empty()) << "less than a pixel";
  detector.window = {8, 8, 1};
  detector.filters = {std::vector<float>(detector.window.filter_size())};
  EXPECT_THROW(detect_landmarks(detector, busy_picture(100, 100, 1), 1, 0), UsageError) << "one cell";
}

// A detector that fires everywhere, as a forged map may hold one.
TEST(DetectLandmarks, HitsWithoutEndAreCutAndTheLookMayBeEnded) {
  LandmarkDetector detector;
  detector.class_name = "anything";
  detector.gsd_m = 1;
  detector.context = 10;
  detector.shortest_m = detector.longest_m = 1;
  detector.threshold = -1e6;
  detector.window = {12, 4, 1};
  Random random(2);
  for (int filter = 0; filter < 4; ++filter) {
    std::vector<float>& weights = detector.filters.emplace_back();
    for (std::size_t i = 0; i < detector.window.filter_size(); ++i) {
      weights.push_back(static_cast<float>(0.01 * random.normal()));
    }
  }
  const cv::Mat picture = busy_picture(800, 800, 4);
  int asked = 0;
  const auto all = detect_landmarks(detector, picture, 1, detector.threshold, 20'000, [&] { ++asked; });
  EXPECT_GT(all.size(), 1000U);
  EXPECT_GT(asked, 50);
  const auto some = detect_landmarks(detector, picture, 1, detector.threshold, 64);
  ASSERT_EQ(some.size(), 64U);
  for (std::size_t i = 0; i < some.size(); ++i) EXPECT_EQ(some[i].center_px, all[i].center_px) << i;
  EXPECT_THROW(detect_landmarks(detector, picture, 1, detector.threshold, 20'000,
                                [left = 10]() mutable {
                                  if (--left == 0) throw UsageError("ended");
                                }),
               UsageError);
}

}  // namespace
}  // namespace pilotage
