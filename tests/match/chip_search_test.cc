#include "pilotage/match/chip_search.h"

#include <limits>

#include "match/chip_scene.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"

namespace pilotage {
namespace {

constexpr int kFactor = 3;

class ChipSearch : public ::testing::Test {
 protected:
  const cv::Mat ground_ = testing::random_ground(150, 140, seed_from_name("ChipSearch"));
  const ChipMosaic mosaic_ = testing::mosaic_of(ground_, 300, 600, kFactor);
  const std::vector<ChipHypothesis> one_ = {{0, 1}};

  Eigen::Vector2d level(double x, double y) const { return mosaic_.level_from_mosaic({x, y}); }
};

TEST_F(ChipSearch, FindsTheNadirPointToAFractionOfAPixel) {
  for (const double contrast_sigma_px : {0.0, 1.5}) {
    for (const Eigen::Vector2d& truth : {Eigen::Vector2d(70, 65), Eigen::Vector2d(61.3, 72.6)}) {
      const RectifiedFrame frame = testing::frame_over(ground_, truth, 50, 36, 25);
      ChipSearchOptions options;
      options.contrast_sigma_px = contrast_sigma_px;
      const ChipMatch match =
          search_chips(frame, mosaic_, level(truth.x() + 11, truth.y() - 9), 20 * kFactor, one_, options);
      ASSERT_TRUE(match.found);
      EXPECT_LT((match.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 0.15 * kFactor);
      EXPECT_GT(match.ncc, 0.9);
      EXPECT_LT(match.rival_ncc, 0.6);
      EXPECT_EQ(match.overlap, 1);
      const ChipMatch confirmed = confirm_chip_match(frame, mosaic_, match, 2, options);
      ASSERT_TRUE(confirmed.found);
      EXPECT_LT((confirmed.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 0.05 * kFactor);
      EXPECT_GT(confirmed.ncc, 0.97);
      EXPECT_EQ(confirmed.rival_ncc, match.rival_ncc);
    }
  }
}

// A frame that must be turned clockwise by 2° and grow by 4 % is found under that hypothesis and no other.
TEST_F(ChipSearch, TellsTurnAndScale) {
  const auto hypotheses = chip_hypotheses(2, 3, 0.04, 3);
  for (const double yaw_deg : {-2.0, 0.0, 2.0}) {
    for (const double scale : {0.96, 1.0, 1.04}) {
      const Eigen::Vector2d truth(72, 66);
      const RectifiedFrame frame = testing::frame_over(ground_, truth, 60, 48, -40, yaw_deg, scale);
      const ChipMatch match = search_chips(frame, mosaic_, level(75, 60), 15 * kFactor, hypotheses);
      ASSERT_TRUE(match.found);
      EXPECT_NEAR(match.yaw_deg, yaw_deg, 1e-9);
      EXPECT_NEAR(match.scale, scale, 1e-9);
      EXPECT_LT((match.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 0.2 * kFactor);
      EXPECT_GT(match.ncc, 0.9);
    }
  }
}

// The nadir point of a tilted camera lies far from the middle of its frame, even outside: turn and scale are about it.
TEST_F(ChipSearch, TurnsAboutANadirPointOutsideTheFrame) {
  const Eigen::Vector2d nadir(75, 70);
  RectifiedFrame frame = testing::frame_over(ground_, nadir, 110, 100, 0, 2, 1.04);
  const cv::Rect kept(20, 20, 50, 44);  // of 152: left and above of the nadir point
  frame.gray = frame.gray(kept).clone();
  frame.valid = frame.valid(kept).clone();
  frame.origin_m += Eigen::Vector2d(kept.x, -kept.y) * frame.gsd_m;
  ASSERT_GT(frame.pixel_from_ground({0, 0}).x(), kept.width);
  const ChipMatch match = search_chips(frame, mosaic_, level(80, 66), 12 * kFactor, {{0, 1}, {2, 1.04}});
  ASSERT_TRUE(match.found);
  EXPECT_EQ(match.yaw_deg, 2);
  EXPECT_LT((match.nadir_px - mosaic_.level_from_mosaic(nadir)).norm(), 0.2 * kFactor);
}

TEST_F(ChipSearch, FindsAFrameThatHalfLeavesTheMap) {
  ChipMosaic part = mosaic_;
  part.valid = mosaic_.valid.clone();
  part.valid(cv::Rect(0, 0, 64, 140)).setTo(0);
  part.gray = mosaic_.gray.clone();
  part.gray.setTo(0, part.valid == 0);
  const Eigen::Vector2d truth(70, 65);
  const RectifiedFrame frame = testing::frame_over(ground_, truth, 50, 36);
  const ChipMatch match = search_chips(frame, part, level(78, 60), 15 * kFactor, one_);
  ASSERT_TRUE(match.found);
  EXPECT_LT((match.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 0.2 * kFactor);
  EXPECT_NEAR(match.overlap, 0.62, 0.03);
  EXPECT_NEAR(match.pixels, 0.62 * 50 * 36, 0.03 * 50 * 36);
  // The same beyond the mosaic's edge, where nothing is valid either.
  ChipMosaic cut = testing::mosaic_of(ground_(cv::Rect(64, 0, 86, 140)).clone(), 300 + 64 * kFactor, 600, kFactor);
  const ChipMatch at_edge = search_chips(frame, cut, level(78, 60), 15 * kFactor, one_);
  ASSERT_TRUE(at_edge.found);
  EXPECT_NEAR(at_edge.ncc, match.ncc, 1e-4);
  EXPECT_LT((at_edge.nadir_px - match.nadir_px).norm(), 1e-3);
  ChipSearchOptions more;
  more.min_overlap = 0.9;
  const ChipMatch elsewhere = search_chips(frame, part, level(78, 60), 15 * kFactor, one_, more);
  EXPECT_GT(elsewhere.overlap, 0.9 * 0.999);
  EXPECT_GT((elsewhere.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 2 * kFactor);
}

// A window wider than the blocks it is searched in: places in every block and on the edges between them, at the ends of
// the mosaic and with a hole beside them, by the answer of a narrow window about each.
TEST_F(ChipSearch, AWideWindowFindsWhatANarrowOneDoes) {
  const cv::Mat ground = testing::random_ground(620, 580, 11);
  ChipMosaic mosaic = testing::mosaic_of(ground, 300, 600, kFactor);
  mosaic.valid(cv::Rect(330, 100, 60, 250)).setTo(0);
  mosaic.gray.setTo(0, mosaic.valid == 0);
  const auto at = [&](double x, double y) { return mosaic.level_from_mosaic({x, y}); };
  for (const Eigen::Vector2d& truth : {Eigen::Vector2d(40, 45), Eigen::Vector2d(255.4, 300), Eigen::Vector2d(256, 257),
                                       Eigen::Vector2d(319.7, 200), Eigen::Vector2d(570, 530)}) {
    const RectifiedFrame frame = testing::frame_over(ground, truth, 60, 48);
    const ChipMatch narrow = search_chips(frame, mosaic, at(truth.x() + 5, truth.y() - 7), 15 * kFactor, one_);
    const ChipMatch wide = search_chips(frame, mosaic, at(312, 288), 312 * kFactor, one_);
    ASSERT_TRUE(narrow.found);
    ASSERT_TRUE(wide.found);
    EXPECT_LT((wide.nadir_px - at(truth.x(), truth.y())).norm(), 0.2 * kFactor) << truth.transpose();
    EXPECT_LT((wide.nadir_px - narrow.nadir_px).norm(), 1e-3) << truth.transpose();
    EXPECT_NEAR(wide.ncc, narrow.ncc, 1e-4) << truth.transpose();
    EXPECT_EQ(wide.pixels, narrow.pixels) << truth.transpose();
    EXPECT_GE(wide.rival_ncc, narrow.rival_ncc - 1e-4) << "the best of more places";
    EXPECT_LT(wide.rival_ncc, 0.7 * wide.ncc);
  }
}

TEST_F(ChipSearch, FromCoarseToFineFindsWhatEveryPositionDoes) {
  const cv::Mat ground = testing::random_ground(420, 380, 13);
  ChipMosaic mosaic = testing::mosaic_of(ground, 300, 600, kFactor);
  mosaic.valid(cv::Rect(230, 100, 60, 150)).setTo(0);
  mosaic.gray.setTo(0, mosaic.valid == 0);
  const Eigen::Vector2d center = mosaic.level_from_mosaic({211, 190});
  const auto coarse = chip_hypotheses(1, 2, 0.02, 2);
  const auto fine = chip_hypotheses(2, 3, 0.04, 3);
  for (const Eigen::Vector2d& truth :
       {Eigen::Vector2d(60, 65), Eigen::Vector2d(180.4, 311), Eigen::Vector2d(351, 300)}) {
    for (const ChipHypothesis& seen : {ChipHypothesis{0, 1}, ChipHypothesis{2, 0.96}, ChipHypothesis{-1.2, 1.02}}) {
      const RectifiedFrame frame = testing::frame_over(ground, truth, 80, 64, 0, seen.yaw_deg, seen.scale);
      const ChipMatch whole = search_chips(frame, mosaic, center, 211 * kFactor, fine);
      const ChipMatch found = search_chips_coarsely(frame, mosaic, center, 211 * kFactor, coarse, fine);
      ASSERT_TRUE(whole.found);
      ASSERT_TRUE(found.found);
      EXPECT_LT((found.nadir_px - whole.nadir_px).norm(), 1e-2) << truth.transpose() << ", " << seen.yaw_deg;
      EXPECT_NEAR(found.ncc, whole.ncc, 1e-3);
      EXPECT_EQ(found.yaw_deg, whole.yaw_deg);
      EXPECT_EQ(found.scale, whole.scale);
      EXPECT_LE(found.rival_ncc, whole.rival_ncc + 1e-3) << "of eight places, not of all";
    }
  }
  EXPECT_FALSE(search_chips_coarsely({}, mosaic, center, 100, coarse, fine).found);
}

TEST_F(ChipSearch, ARivalInAnotherBlockIsOne) {
  cv::Mat twice = testing::random_ground(620, 80, 12);
  twice(cv::Rect(20, 15, 50, 40)).copyTo(twice(cv::Rect(520, 15, 50, 40)));
  const ChipMosaic mosaic = testing::mosaic_of(twice, 300, 600, kFactor);
  const RectifiedFrame frame = testing::frame_over(twice, {45, 35}, 40, 30);
  const ChipMatch match = search_chips(frame, mosaic, mosaic.level_from_mosaic({310, 40}), 310 * kFactor, one_);
  ASSERT_TRUE(match.found);
  EXPECT_GT(match.rival_ncc, match.ncc - 0.02);
}

TEST_F(ChipSearch, WhatTheCheckpointThrowsEndsIt) {
  const RectifiedFrame frame = testing::frame_over(ground_, {70, 65}, 40, 30);
  EXPECT_THROW(search_chips(frame, mosaic_, level(70, 65), 20 * kFactor, one_, {}, [] { throw 7; }), int);
}

TEST_F(ChipSearch, ARepeatedPlaceIsARival) {
  cv::Mat twice = ground_.clone();
  ground_(cv::Rect(45, 45, 50, 40)).copyTo(twice(cv::Rect(45, 95, 50, 40)));
  const RectifiedFrame frame = testing::frame_over(ground_, {70, 65}, 40, 30);
  const ChipMosaic map = testing::mosaic_of(twice, 300, 600, kFactor);
  const ChipMatch alone = search_chips(frame, map, level(70, 65), 20 * kFactor, one_);
  const ChipMatch both = search_chips(frame, map, level(70, 90), 40 * kFactor, one_);
  EXPECT_LT(alone.rival_ncc, 0.5);
  EXPECT_GT(both.rival_ncc, 0.95);
  ChipSearchOptions wide;
  wide.exclusion_px = 200;
  EXPECT_EQ(search_chips(frame, map, level(70, 90), 40 * kFactor, one_, wide).rival_ncc, 0);
}

TEST_F(ChipSearch, LooksOnlyWithinTheWindow) {
  const RectifiedFrame frame = testing::frame_over(ground_, {70, 65}, 40, 30);
  const ChipMatch match = search_chips(frame, mosaic_, level(90, 65), 10 * kFactor, one_);
  ASSERT_TRUE(match.found);
  EXPECT_LE((match.nadir_px - level(90, 65)).cwiseAbs().maxCoeff(), 10.5 * kFactor);
  EXPECT_LT(match.ncc, 0.6);
}

TEST_F(ChipSearch, AnswersAnyInput) {
  const RectifiedFrame good = testing::frame_over(ground_, {70, 65}, 40, 30);
  const auto found = [&](const RectifiedFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center,
                         double half_width_px, const std::vector<ChipHypothesis>& hypotheses) {
    const ChipMatch match = search_chips(frame, mosaic, center, half_width_px, hypotheses);
    ChipMatch candidate;
    candidate.nadir_px = center;
    if (!hypotheses.empty()) candidate.yaw_deg = hypotheses[0].yaw_deg;
    if (!hypotheses.empty()) candidate.scale = hypotheses[0].scale;
    confirm_chip_match(frame, mosaic, candidate, 2);
    return match.found;
  };
  const Eigen::Vector2d here = level(70, 65);
  ASSERT_TRUE(found(good, mosaic_, here, 30, one_));
  EXPECT_FALSE(found({}, mosaic_, here, 30, one_));
  EXPECT_FALSE(found(good, {}, here, 30, one_));
  EXPECT_FALSE(found(good, mosaic_, here, 30, {}));
  EXPECT_FALSE(found(good, mosaic_, here, kNaN, one_));
  EXPECT_FALSE(found(good, mosaic_, here, -1, one_));
  EXPECT_FALSE(found(good, mosaic_, {kNaN, 0}, 30, one_));
  EXPECT_FALSE(found(good, mosaic_, {1e300, -1e300}, 30, one_));
  EXPECT_FALSE(found(good, mosaic_, {1e9, 1e9}, 30, one_));
  for (const ChipHypothesis& bad : {ChipHypothesis{kNaN, 1}, ChipHypothesis{0, kNaN}, ChipHypothesis{0, 0}}) {
    EXPECT_FALSE(found(good, mosaic_, here, 30, {bad}));
  }
  EXPECT_TRUE(found(good, mosaic_, here, 1e300, one_)) << "the window is cut to the mosaic";
  EXPECT_TRUE(found(good, mosaic_, here, 0, one_)) << "one place only";
  RectifiedFrame frame = good;
  frame.valid = cv::Mat::zeros(good.valid.size(), CV_8UC1);
  EXPECT_FALSE(found(frame, mosaic_, here, 30, one_));
  frame = good;
  frame.gray = cv::Mat(good.gray.size(), CV_8UC1, cv::Scalar(128));
  EXPECT_FALSE(found(frame, mosaic_, here, 30, one_)) << "no contrast";
  frame = good;
  frame.origin_m = {1e12, kNaN};
  EXPECT_FALSE(found(frame, mosaic_, here, 30, one_));
  ChipMosaic nothing = mosaic_;
  nothing.valid = cv::Mat::zeros(ground_.size(), CV_8UC1);
  EXPECT_FALSE(found(good, nothing, here, 30, one_));
  EXPECT_THROW(chip_hypotheses(1, 0, 0, 1), UsageError);
  EXPECT_EQ(chip_hypotheses(1, 1, 0.1, 1).size(), 1u);
  EXPECT_EQ(chip_hypotheses(1, 1, 0.1, 1)[0].scale, 1);
}

}  // namespace
}  // namespace pilotage
