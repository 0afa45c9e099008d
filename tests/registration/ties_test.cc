#include "pilotage/registration/ties.h"

#include <algorithm>

#include "registration/two_dates.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/statistics.h"

namespace pilotage {
namespace {

using testing::make_two_dates;
using testing::TwoDates;

const Eigen::Vector2d kShift_m(5.3, -3.7);

TwoDates shifted() {
  return make_two_dates(
      400, [](const Eigen::Vector2d&) { return kShift_m; }, "ties");
}

TieSearch find(const TwoDates& dates, int radius_px, int threads = 1) {
  TieOptions options;
  options.template_px = 48;
  return find_ties(gray_source_from(dates.reference), gray_source_from(dates.second), radius_px, options, {}, threads);
}

TEST(Ties, FindTheShiftToAFractionOfAPixel) {
  const TieSearch search = find(shifted(), 10);
  EXPECT_EQ(search.places, 121);  // (400 - 2 · 10 - 48) / 32 + 1, squared
  ASSERT_GE(search.ties.size(), 110U);
  for (const Tie& tie : search.ties) {
    EXPECT_LT((tie.displacement_m - kShift_m).norm(), 0.15) << tie.point_m.transpose();
    EXPECT_GT(tie.ncc, 0.9);
    EXPECT_EQ(tie.gsd_m, 1);
  }
}

TEST(Ties, LieAtTheMiddleOfTheirSquare) {
  const TieSearch search = find(shifted(), 10);
  EXPECT_EQ(search.ties.front().point_m, Eigen::Vector2d(1000 + 10 + 24, 5000 - 10 - 24));
}

TEST(Ties, NoneBeyondTheRadius) {
  EXPECT_LE(find(shifted(), 4).ties.size(), 2U) << "the true place is outside the search";
}

TEST(Ties, HardlyAnyBetweenDifferentGround) {
  TwoDates dates = shifted();
  dates.second.pixels = testing::random_texture(400, "elsewhere");
  for (const TieShadows shadows : {TieShadows::kIgnore, TieShadows::kFollow}) {
    TieOptions options;
    options.shadows = shadows;
    const TieSearch search =
        find_ties(gray_source_from(dates.reference), gray_source_from(dates.second), 10, options, {}, 1);
    EXPECT_EQ(search.places, 81);
    EXPECT_LE(search.ties.size(), 3U);  // below 4 %, which counts as none (register_dates)
  }
}

TEST(Ties, NoneWithoutGround) {
  TwoDates dates = shifted();
  dates.second.valid(cv::Rect(0, 0, 200, 400)) = 0;
  dates.second.pixels(cv::Rect(0, 0, 200, 400)) = 77;  // what stands there must not matter
  const TieSearch search = find(dates, 10);
  EXPECT_GE(search.ties.size(), 55U);
  for (const Tie& tie : search.ties) {
    EXPECT_GT(tie.point_m.x(), 1200 + 24 - 0.31 * 48 - kShift_m.x());
    EXPECT_LT((tie.displacement_m - kShift_m).norm(), 0.3);
  }
}

TEST(Ties, SurviveAnotherTone) {
  TwoDates dates = shifted();
  cv::Mat(255 - dates.second.pixels).convertTo(dates.second.pixels, CV_16U, -60, 40000);  // inverted twice, stretched
  dates.second.map_from_pixel = dates.reference.map_from_pixel;
  const TieSearch search = find(dates, 10);
  EXPECT_GE(search.ties.size(), 110U);
}

TEST(Ties, StandOnTheGroundAndNotOnShadowsThatFallAnotherWay) {
  TwoDates dates = shifted();
  const cv::Mat texture = testing::random_texture(400, "lit");
  dates.reference.pixels = testing::ground_with_shadows(texture, {-3, -2});
  dates.second.pixels = testing::ground_with_shadows(texture, {3, 2});
  TieOptions options;
  const auto medians_m = [&](const TieOptions& with) {
    std::vector<double> off_m;
    for (const Tie& tie :
         find_ties(gray_source_from(dates.reference), gray_source_from(dates.second), 12, with, {}, 1).ties) {
      off_m.push_back(tie.displacement_m.norm());
    }
    EXPECT_GT(off_m.size(), 40U);
    return quantile(off_m, 0.5);
  };
  EXPECT_LT(medians_m(options), 0.1);
  options.shadows = TieShadows::kFollow;
  EXPECT_GT(medians_m(options), 5);  // of the 7.2 m between the shadows
}

TEST(Ties, OfAPlaceDoNotDependOnWhichOthersAreWanted) {
  TwoDates dates = shifted();
  const cv::Mat texture = testing::random_texture(400, "lit");
  dates.reference.pixels = testing::ground_with_shadows(texture, {-3, -2});
  dates.second.pixels = testing::ground_with_shadows(texture, {3, 2});
  const auto find_in = [&](const Wanted& wanted) {
    return find_ties(gray_source_from(dates.reference), gray_source_from(dates.second), 4, {}, wanted, 1).ties;
  };
  const std::vector<Tie> all = find_in({});
  const std::vector<Tie> some = find_in([](const Bounds& square) { return square.min_x_m < 1100; });
  ASSERT_GT(some.size(), 10U);
  ASSERT_GT(all.size(), some.size());
  for (const Tie& tie : some) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Tie& one) { return one.point_m == tie.point_m; });
    ASSERT_NE(found, all.end());
    EXPECT_NEAR((found->displacement_m - tie.displacement_m).norm(), 0, 1e-3);
    EXPECT_NEAR(found->ncc, tie.ncc, 1e-4);
  }
}

TEST(Ties, NoneWhereHardlyAnythingIsLit) {
  TwoDates dates = shifted();
  cv::Mat texture = testing::random_texture(400, "lit");
  texture.convertTo(texture, CV_8U, 0.05, 200);
  texture *= 0.2;
  cv::Mat strip = texture(cv::Rect(112, 0, 8, 400));  // all the rest is dark beside it
  strip *= 6;
  dates.reference.pixels = texture;
  dates.second.pixels = texture.clone();
  TieOptions options;
  options.template_px = 32;
  const Wanted at_strip = [](const Bounds& square) { return std::abs(square.min_x_m - 1100) < 8; };
  const auto count = [&](const TieOptions& with) {
    return find_ties(gray_source_from(dates.reference), gray_source_from(dates.second), 4, with, at_strip, 1)
        .ties.size();
  };
  EXPECT_EQ(count(options), 0U);
  options.shadows = TieShadows::kFollow;
  options.min_margin = 0;
  EXPECT_GT(count(options), 0U);
}

TEST(Ties, OnlyWhereWanted) {
  const TwoDates dates = shifted();
  TieOptions options;
  options.template_px = 48;
  const Bounds wanted{1000, 4900, 1100, 5000};
  const TieSearch search = find_ties(gray_source_from(dates.reference), gray_source_from(dates.second), 10, options,
                                     [&](const Bounds& bounds) { return bounds.intersects(wanted); });
  EXPECT_EQ(search.places, 9);
}

TEST(Ties, DoNotDependOnThreads) {
  const TieSearch one = find(shifted(), 10, 1);
  const TieSearch three = find(shifted(), 10, 3);
  ASSERT_EQ(one.ties.size(), three.ties.size());
  for (std::size_t i = 0; i < one.ties.size(); ++i) {
    EXPECT_EQ(one.ties[i].displacement_m, three.ties[i].displacement_m);
    EXPECT_EQ(one.ties[i].ncc, three.ties[i].ncc);
  }
}

TEST(Ties, RefuseDifferentGridsAndBadOptions) {
  TwoDates dates = shifted();
  TieOptions options;
  options.min_ncc = 2;
  EXPECT_THROW(find_ties(gray_source_from(dates.reference), gray_source_from(dates.second), 10, options), UsageError);
  EXPECT_THROW(find(dates, 1), UsageError);
  dates.second.map_from_pixel.origin_x += 1;
  EXPECT_THROW(find(dates, 10), UsageError);
}

}  // namespace
}  // namespace pilotage
