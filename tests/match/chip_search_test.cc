#include "pilotage/match/chip_search.h"

#include <limits>

#include "match/chip_scene.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/match/chip_correlation.h"
#include "pilotage/match/chip_templates.h"
#include "pilotage/vision/masked_correlation.h"

namespace pilotage {
namespace {

constexpr int kFactor = 3;

ChipFrame frame_over(const cv::Mat& ground, const Eigen::Vector2d& nadir, int width, int height,
                     double rectangle_deg = 0, double yaw_deg = 0, double scale = 1) {
  return make_chip_frame(testing::frame_over(ground, nadir, width, height, rectangle_deg, yaw_deg, scale));
}

/// The best of search_chips.
ChipMatch best_match(const ChipFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center_px,
                     double half_width_px, const std::vector<ChipHypothesis>& hypotheses,
                     const ChipSearchOptions& options = {}) {
  const auto matches = search_chips(frame, mosaic, center_px, half_width_px, hypotheses, options);
  return matches.empty() ? ChipMatch() : matches.front();
}

double best_rival(const ChipFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center_px,
                  double half_width_px) {
  const auto matches = search_chips(frame, mosaic, center_px, half_width_px, {{0, 1}});
  return matches.empty() ? 0 : rival_ncc(matches, matches.front().nadir_px, 1);
}

class ChipSearch : public ::testing::Test {
 protected:
  const cv::Mat ground_ = testing::random_ground(150, 140, seed_from_name("ChipSearch"));
  const ChipMosaic mosaic_ = testing::mosaic_of(ground_, 300, 600, kFactor);
  const std::vector<ChipHypothesis> one_ = {{0, 1}};

  Eigen::Vector2d level(double x, double y) const { return mosaic_.level_from_mosaic({x, y}); }
};

TEST_F(ChipSearch, FindsTheNadirPointToAFractionOfAPixel) {
  for (const Eigen::Vector2d& truth : {Eigen::Vector2d(70, 65), Eigen::Vector2d(61.3, 72.6)}) {
    const ChipFrame frame = frame_over(ground_, truth, 50, 36, 25);
    const auto matches = search_chips(frame, mosaic_, level(truth.x() + 11, truth.y() - 9), 20 * kFactor, one_);
    ASSERT_FALSE(matches.empty());
    const ChipMatch& match = matches.front();
    EXPECT_LT((match.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 0.25 * kFactor);
    EXPECT_GT(match.ncc, 0.6);
    EXPECT_LT(rival_ncc(matches, match.nadir_px, 1), 0.5 * match.ncc);
    EXPECT_EQ(match.overlap, 1);
    ChipMatch near = match;
    near.nadir_px += Eigen::Vector2d(2, -1) * kFactor;
    const ChipMatch confirmed = confirm_chip_match(frame, mosaic_, near, 3);
    ASSERT_TRUE(confirmed.found);
    EXPECT_LT((confirmed.nadir_px - match.nadir_px).norm(), 1e-6);
    EXPECT_EQ(confirmed.ncc, match.ncc);
    EXPECT_EQ(confirmed.pixels, match.pixels);
  }
}

// The sums of fields of 8 bits against those of MaskedCorrelation in floats, over a mask and beside a hole.
TEST_F(ChipSearch, AgreesWithTheMaskedCorrelation) {
  ChipMosaic holes = mosaic_;
  holes.valid = mosaic_.valid.clone();
  holes.valid(cv::Rect(50, 40, 17, 60)).setTo(0);
  const ChipFrame frame = frame_over(ground_, {70, 65}, 50, 36, 25, 1);
  const auto templates = make_chip_templates(frame, {{1.5, 1.01}});
  ASSERT_TRUE(templates.has_value());
  const ChipRegion region = cut_chip_region(holes, {{0, 0}, holes.valid.size()});
  const MaskedCorrelation correlation(templates->mask, region.z, region.valid, 0.5, 1e-3,
                                      opencv_sums_of_products(templates->mask.size(), region.z.size()));
  const cv::Mat surface = correlation.surface(templates->z[0]);
  const double needed_px = 0.5 * cv::countNonZero(templates->mask);
  int compared = 0;
  for (int y = 0; y < surface.rows; y += 7) {
    for (int x = 0; x < surface.cols; x += 7) {
      const cv::Point nadir(x - templates->canvas.left, y - templates->canvas.top);
      const ChipPeak there = climb(*templates, 0, holes, nadir, 0, needed_px);
      const double expected = static_cast<double>(surface.at<float>(y, x));
      if (expected < -1) {
        EXPECT_EQ(there.pixels, 0);
        continue;
      }
      ++compared;
      EXPECT_NEAR(there.ncc, expected, 0.01);
      EXPECT_EQ(there.pixels, static_cast<int>(correlation.counts().at<float>(y, x)));
    }
  }
  EXPECT_GT(compared, 30);
}

// Turned ground has the directions turned by as much: the phase by twice the angle.
TEST_F(ChipSearch, TurningAFrameTurnsItsDirections) {
  const cv::Mat ground = testing::random_ground(200, 200, 21);
  for (const double yaw_deg : {30.0, 90.0, -45.0}) {
    const ChipFrame turned = frame_over(ground, {100, 100}, 80, 60, 0, yaw_deg);
    const auto match = best_match(turned, testing::mosaic_of(ground, 0, 0, 1), {103, 98}, 10, {{yaw_deg, 1}});
    ASSERT_TRUE(match.found) << yaw_deg;
    EXPECT_LT((match.nadir_px - Eigen::Vector2d(100, 100)).norm(), 0.3) << yaw_deg;
    EXPECT_GT(match.ncc, 0.55) << yaw_deg;
  }
}

TEST_F(ChipSearch, LightAndShadeMayChangePlaces) {
  const Eigen::Vector2d truth(70, 65);
  const ChipMatch as_it_was = best_match(frame_over(ground_, truth, 50, 36, 25), mosaic_, level(75, 60), 60, one_);
  const cv::Mat negative = 255 - ground_;
  const ChipMatch match = best_match(frame_over(negative, truth, 50, 36, 25), mosaic_, level(75, 60), 60, one_);
  ASSERT_TRUE(match.found);
  EXPECT_LT((match.nadir_px - as_it_was.nadir_px).norm(), 0.1);
  EXPECT_NEAR(match.ncc, as_it_was.ncc, 0.01);
}

// A frame that must be turned clockwise by 2° and grow by 4 % is found under that hypothesis and no other.
TEST_F(ChipSearch, TellsTurnAndScale) {
  const auto hypotheses = chip_hypotheses(2, 3, 0.04, 3);
  for (const double yaw_deg : {-2.0, 0.0, 2.0}) {
    for (const double scale : {0.96, 1.0, 1.04}) {
      const Eigen::Vector2d truth(72, 66);
      const ChipFrame frame = frame_over(ground_, truth, 60, 48, -40, yaw_deg, scale);
      const ChipMatch match = best_match(frame, mosaic_, level(75, 60), 15 * kFactor, hypotheses);
      ASSERT_TRUE(match.found);
      EXPECT_NEAR(match.yaw_deg, yaw_deg, 1e-9);
      EXPECT_NEAR(match.scale, scale, 1e-9);
      EXPECT_LT((match.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 0.2 * kFactor);
      EXPECT_GT(match.ncc, 0.6);
    }
  }
}

// The nadir point of a tilted camera lies far from the middle of its frame, even outside: turn and scale are about it.
TEST_F(ChipSearch, TurnsAboutANadirPointOutsideTheFrame) {
  const Eigen::Vector2d nadir(75, 70);
  ChipFrame frame = frame_over(ground_, nadir, 110, 100, 0, 2, 1.04);
  const cv::Rect kept(20, 20, 50, 44);  // left and above of the nadir point
  frame.z = frame.z(kept).clone();
  frame.valid = frame.valid(kept).clone();
  frame.nadir_px -= Eigen::Vector2d(kept.x, kept.y);
  ASSERT_GT(frame.nadir_px.x(), kept.width);
  const ChipMatch match = best_match(frame, mosaic_, level(80, 66), 12 * kFactor, {{0, 1}, {1, 1.02}, {2, 1.04}});
  ASSERT_TRUE(match.found);
  EXPECT_EQ(match.yaw_deg, 2);
  EXPECT_LT((match.nadir_px - mosaic_.level_from_mosaic(nadir)).norm(), 0.25 * kFactor);
}

TEST_F(ChipSearch, FindsAFrameThatHalfLeavesTheMap) {
  ChipMosaic part = mosaic_;
  part.valid = mosaic_.valid.clone();
  part.valid(cv::Rect(0, 0, 64, 140)).setTo(0);
  part.steps = mosaic_.steps.clone();
  part.steps.setTo(0, part.valid == 0);
  const Eigen::Vector2d truth(70, 65);
  const ChipFrame frame = frame_over(ground_, truth, 50, 36);
  const ChipMatch match = best_match(frame, part, level(78, 60), 15 * kFactor, one_);
  ASSERT_TRUE(match.found);
  EXPECT_LT((match.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 0.2 * kFactor);
  EXPECT_NEAR(match.overlap, 0.62, 0.03);
  EXPECT_NEAR(match.pixels, 0.62 * 50 * 36, 0.03 * 50 * 36);
  // The same beyond the mosaic's edge, where nothing is valid either.
  const cv::Rect right_part(64, 0, 86, 140);
  const ChipMosaic cut{mosaic_.steps(right_part).clone(), mosaic_.valid(right_part).clone(), 300 + 64 * kFactor, 600,
                       kFactor};
  const ChipMatch at_edge = best_match(frame, cut, level(78, 60), 15 * kFactor, one_);
  ASSERT_TRUE(at_edge.found);
  EXPECT_NEAR(at_edge.ncc, match.ncc, 1e-4);
  EXPECT_LT((at_edge.nadir_px - match.nadir_px).norm(), 1e-3);
  ChipSearchOptions more;
  more.min_overlap = 0.9;
  const ChipMatch elsewhere = best_match(frame, part, level(78, 60), 15 * kFactor, one_, more);
  EXPECT_GT(elsewhere.overlap, 0.9 * 0.999);
  EXPECT_GT((elsewhere.nadir_px - mosaic_.level_from_mosaic(truth)).norm(), 2 * kFactor);
}

// A window wider than the blocks it is searched in: places in every block and on the edges between them, at the ends of
// the mosaic and with a hole beside them, by the answer of a narrow window about each.
TEST_F(ChipSearch, AWideWindowFindsWhatANarrowOneDoes) {
  const cv::Mat ground = testing::random_ground(620, 580, 11);
  ChipMosaic mosaic = testing::mosaic_of(ground, 300, 600, kFactor);
  mosaic.valid(cv::Rect(330, 100, 60, 250)).setTo(0);
  mosaic.steps.setTo(0, mosaic.valid == 0);
  const auto at = [&](double x, double y) { return mosaic.level_from_mosaic({x, y}); };
  for (const Eigen::Vector2d& truth : {Eigen::Vector2d(40, 45), Eigen::Vector2d(255.4, 300), Eigen::Vector2d(256, 257),
                                       Eigen::Vector2d(319.7, 200), Eigen::Vector2d(570, 530)}) {
    const ChipFrame frame = frame_over(ground, truth, 60, 48);
    const ChipMatch narrow = best_match(frame, mosaic, at(truth.x() + 5, truth.y() - 7), 15 * kFactor, one_);
    const ChipMatch wide = best_match(frame, mosaic, at(312, 288), 312 * kFactor, one_);
    ASSERT_TRUE(narrow.found);
    ASSERT_TRUE(wide.found);
    EXPECT_LT((wide.nadir_px - at(truth.x(), truth.y())).norm(), 0.2 * kFactor) << truth.transpose();
    EXPECT_LT((wide.nadir_px - narrow.nadir_px).norm(), 1e-3) << truth.transpose();
    EXPECT_NEAR(wide.ncc, narrow.ncc, 1e-4) << truth.transpose();
    EXPECT_EQ(wide.pixels, narrow.pixels) << truth.transpose();
    EXPECT_LT(best_rival(frame, mosaic, at(312, 288), 312 * kFactor), 0.7 * wide.ncc);
  }
}

// Against every hypothesis at every position.
TEST_F(ChipSearch, FromCoarseToFineFindsWhatEveryPositionDoes) {
  const auto hypotheses = chip_hypotheses(2, 3, 0.04, 3);
  for (const Eigen::Vector2d& truth : {Eigen::Vector2d(55, 62), Eigen::Vector2d(80.4, 71)}) {
    for (const ChipHypothesis& seen : {ChipHypothesis{0, 1}, ChipHypothesis{2, 0.96}, ChipHypothesis{-1.2, 1.02}}) {
      const ChipFrame frame = frame_over(ground_, truth, 60, 48, 0, seen.yaw_deg, seen.scale);
      const auto templates = make_chip_templates(frame, hypotheses);
      ASSERT_TRUE(templates.has_value());
      double highest = 0;
      for (std::size_t i = 0; i < hypotheses.size(); ++i) {
        for (int y = 52; y <= 80; ++y) {
          for (int x = 50; x <= 90; ++x) {
            const double needed_px = 0.5 * cv::countNonZero(templates->mask);
            highest = std::max(highest, climb(*templates, i, mosaic_, {x, y}, 0, needed_px).ncc);
          }
        }
      }
      const ChipMatch found = best_match(frame, mosaic_, level(70, 66), 20 * kFactor, hypotheses);
      ASSERT_TRUE(found.found);
      EXPECT_NEAR(found.ncc, highest, 1e-3) << truth.transpose() << ", " << seen.yaw_deg;
    }
  }
}

TEST_F(ChipSearch, PlacesAreApartAndTheBestIsFirst) {
  const auto matches = search_chips(frame_over(ground_, {70, 65}, 40, 30), mosaic_, level(70, 65), 40 * kFactor, one_);
  ASSERT_GT(matches.size(), 2u);
  EXPECT_LE(matches.size(), 8u);
  for (std::size_t i = 1; i < matches.size(); ++i) {
    EXPECT_LE(matches[i].ncc, matches[i - 1].ncc);
    EXPECT_GT((matches[i].nadir_px - matches[0].nadir_px).cwiseAbs().maxCoeff(), 8 * kFactor);
  }
}

TEST_F(ChipSearch, ARivalInAnotherBlockIsOne) {
  cv::Mat twice = testing::random_ground(620, 80, 12);
  twice(cv::Rect(20, 15, 50, 40)).copyTo(twice(cv::Rect(520, 15, 50, 40)));
  const ChipMosaic mosaic = testing::mosaic_of(twice, 300, 600, kFactor);
  const ChipFrame frame = frame_over(twice, {45, 35}, 40, 30);
  const ChipMatch match = best_match(frame, mosaic, mosaic.level_from_mosaic({310, 40}), 310 * kFactor, one_);
  ASSERT_TRUE(match.found);
  EXPECT_GT(best_rival(frame, mosaic, mosaic.level_from_mosaic({310, 40}), 310 * kFactor), match.ncc - 0.1);
}

TEST_F(ChipSearch, WhatTheCheckpointThrowsEndsIt) {
  const ChipFrame frame = frame_over(ground_, {70, 65}, 40, 30);
  EXPECT_THROW(search_chips(frame, mosaic_, level(70, 65), 20 * kFactor, one_, {}, [] { throw 7; }), int);
}

TEST_F(ChipSearch, ARepeatedPlaceIsARival) {
  cv::Mat twice = ground_.clone();
  ground_(cv::Rect(45, 45, 50, 40)).copyTo(twice(cv::Rect(45, 95, 50, 40)));
  const ChipFrame frame = frame_over(ground_, {70, 65}, 40, 30);
  const ChipMosaic map = testing::mosaic_of(twice, 300, 600, kFactor);
  EXPECT_LT(best_rival(frame, map, level(70, 65), 20 * kFactor), 0.5);
  EXPECT_GT(best_rival(frame, map, level(70, 90), 40 * kFactor), 0.6);
  ChipSearchOptions wide;
  wide.exclusion_px = 200;
  EXPECT_EQ(search_chips(frame, map, level(70, 90), 40 * kFactor, one_, wide).size(), 1u);
}

TEST_F(ChipSearch, LooksOnlyWithinTheWindow) {
  const ChipFrame frame = frame_over(ground_, {70, 65}, 40, 30);
  const ChipMatch match = best_match(frame, mosaic_, level(90, 65), 10 * kFactor, one_);
  ASSERT_TRUE(match.found);
  EXPECT_LE((match.nadir_px - level(90, 65)).cwiseAbs().maxCoeff(), 14.5 * kFactor);
  EXPECT_LT(match.ncc, 0.6);
}

TEST_F(ChipSearch, AnswersAnyInput) {
  const ChipFrame good = frame_over(ground_, {70, 65}, 40, 30);
  const auto found = [&](const ChipFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center,
                         double half_width_px, const std::vector<ChipHypothesis>& hypotheses) {
    const auto matches = search_chips(frame, mosaic, center, half_width_px, hypotheses);
    ChipMatch candidate;
    candidate.nadir_px = center;
    if (!hypotheses.empty()) candidate.yaw_deg = hypotheses[0].yaw_deg;
    if (!hypotheses.empty()) candidate.scale = hypotheses[0].scale;
    confirm_chip_match(frame, mosaic, candidate, 2);
    return !matches.empty();
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
  const RectifiedFrame seen = testing::frame_over(ground_, {70, 65}, 40, 30);
  RectifiedFrame frame = seen;
  frame.valid = cv::Mat::zeros(seen.valid.size(), CV_8UC1);
  EXPECT_FALSE(found(make_chip_frame(frame), mosaic_, here, 30, one_));
  frame = seen;
  frame.gray = cv::Mat(seen.gray.size(), CV_8UC1, cv::Scalar(128));
  EXPECT_FALSE(found(make_chip_frame(frame), mosaic_, here, 30, one_)) << "no edges";
  frame = seen;
  frame.origin_m = {1e12, kNaN};
  EXPECT_TRUE(make_chip_frame(frame).z.empty());
  EXPECT_TRUE(make_chip_frame({}).z.empty());
  ChipMosaic nothing = mosaic_;
  nothing.valid = cv::Mat::zeros(ground_.size(), CV_8UC1);
  EXPECT_FALSE(found(good, nothing, here, 30, one_));
  EXPECT_THROW(chip_hypotheses(1, 0, 0, 1), UsageError);
  EXPECT_EQ(chip_hypotheses(1, 1, 0.1, 1).size(), 1u);
  EXPECT_EQ(chip_hypotheses(1, 1, 0.1, 1)[0].scale, 1);
}

}  // namespace
}  // namespace pilotage
