#include "pilotage/registration/register_dates.h"

#include <cmath>
#include <set>

#include "registration/two_dates.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/registration/disagreement_raster.h"

namespace pilotage {
namespace {

using testing::make_two_dates;
using testing::open_in_memory;
using testing::TwoDates;

constexpr int kRegisteredSide_px = 800;
const Bounds kArea{1000, 5000 - kRegisteredSide_px, 1000 + kRegisteredSide_px, 5000};

/// 0 to 20 m, as two real georeferences disagree.
Eigen::Vector2d bent_field(const Eigen::Vector2d& p) {
  const double u = (p.x() - 1000) / kRegisteredSide_px;
  const double v = (5000 - p.y()) / kRegisteredSide_px;
  return {14 * u * u - 3 * v, 9 * u * v + 4 * std::sin(3 * v)};
}

struct Worst {
  double error_m = 0;
  int known = 0;
  int places = 0;
};

Worst compare(const WarpField& found, double margin_m) {
  Worst worst;
  for (double x = kArea.min_x_m + margin_m; x < kArea.max_x_m - margin_m; x += 20) {
    for (double y = kArea.min_y_m + margin_m; y < kArea.max_y_m - margin_m; y += 20) {
      ++worst.places;
      const Eigen::Vector2d moved = found.displacement_m(x, y);
      if (moved.hasNaN()) continue;
      ++worst.known;
      worst.error_m = std::max(worst.error_m, (moved - bent_field({x, y})).norm());
    }
  }
  return worst;
}

TEST(RegisterDates, FindsAKnownFieldToHalfAPixel) {
  const TwoDates dates = make_two_dates(kRegisteredSide_px, bent_field, "register");
  const Registration result = register_dates(open_in_memory(dates), kArea, 1, {});
  const Worst worst = compare(result.fit.field, 40);
  EXPECT_EQ(worst.known, worst.places);
  EXPECT_LT(worst.error_m, 0.5);
  EXPECT_LT(result.fit.left_out_m.median, 0.2);
  EXPECT_GT(result.finest_ties, result.places * 9 / 10);
  EXPECT_NEAR(result.fit.disagreement_m.largest,
              bent_field({1000 + kRegisteredSide_px, 5000 - kRegisteredSide_px}).norm(), 3);
}

/// A third of the ground has changed wholly, in squares of 50 m, the light has changed, and there is noise.
TEST(RegisterDates, HoldsWhereMuchHasChanged) {
  TwoDates dates = make_two_dates(kRegisteredSide_px, bent_field, "changed");
  const cv::Mat other = testing::random_texture(kRegisteredSide_px, "other ground");
  Random random(seed_from_name("squares"));
  for (int row = 0; row < kRegisteredSide_px; row += 50) {
    for (int col = 0; col < kRegisteredSide_px; col += 50) {
      if (random.below(3) != 0) continue;
      const cv::Rect square(col, row, 50, 50);
      other(square).copyTo(dates.second.pixels(square));
    }
  }
  dates.second.pixels.convertTo(dates.second.pixels, CV_8U, 0.6, 70);
  const Registration result = register_dates(open_in_memory(dates), kArea, 1, {});
  const Worst worst = compare(result.fit.field, 60);
  EXPECT_GT(worst.known, worst.places * 9 / 10);
  EXPECT_LT(worst.error_m, 1);
  EXPECT_LT(result.fit.left_out_m.median, 0.5);
}

TEST(RegisterDates, KnowsOnlyWhereBothHaveGround) {
  TwoDates dates = make_two_dates(kRegisteredSide_px, bent_field, "overlap");
  dates.second.valid(cv::Rect(0, 0, kRegisteredSide_px / 2, kRegisteredSide_px)) = 0;
  const Registration result = register_dates(open_in_memory(dates), kArea, 1, {});
  EXPECT_TRUE(result.fit.field.known(1600, 4600));
  EXPECT_FALSE(result.fit.field.known(1100, 4600));
  EXPECT_LT((result.fit.field.displacement_m(1600, 4600) - bent_field({1600, 4600})).norm(), 0.5);

  const DisagreementRaster raster = disagreement_raster(result.fit.field, kArea);
  ASSERT_EQ(raster.bands.size(), 4U);
  const Eigen::Vector2d pixel = raster.map_from_pixel.pixel_from_map({1600, 4600});
  const auto at = [&](std::size_t band, const Eigen::Vector2d& place) {
    return static_cast<double>(
        raster.bands[band].values.at<float>(static_cast<int>(place.y()), static_cast<int>(place.x())));
  };
  EXPECT_EQ(raster.bands[2].name, "magnitude_m");
  EXPECT_NEAR(at(0, pixel), bent_field({1600, 4600}).x(), 1);
  EXPECT_NEAR(at(1, pixel), bent_field({1600, 4600}).y(), 1);
  EXPECT_NEAR(at(2, pixel), std::hypot(at(0, pixel), at(1, pixel)), 1e-4);
  EXPECT_GT(at(3, pixel), 0);
  EXPECT_TRUE(std::isnan(at(2, raster.map_from_pixel.pixel_from_map({1100, 4600}))));
}

/// Both dates show one ground, and shadows that fall another way.
TEST(RegisterDates, GroundOutsideOfShadowsDecides) {
  TwoDates dates = make_two_dates(
      kRegisteredSide_px, [](const Eigen::Vector2d&) { return Eigen::Vector2d::Zero().eval(); }, "shadows");
  const cv::Mat texture = testing::random_texture(kRegisteredSide_px, "shadows");
  dates.reference.pixels = testing::ground_with_shadows(texture, {-3, -2});
  dates.second.pixels = testing::ground_with_shadows(texture, {3, 2});
  RegistrationOptions options;
  const Registration lit = register_dates(open_in_memory(dates), kArea, 1, options);
  EXPECT_LT(lit.fit.disagreement_m.quantile_95, 0.5);
  EXPECT_LT(lit.fit.left_out_m.median, 0.3);
  EXPECT_THAT(shadows_assumption(options, 1), ::testing::HasSubstr("outside of shadows"));
  EXPECT_THAT(shadows_assumption(options, 2), ::testing::HasSubstr("fall alike"));  // there they are correlated
  options.ties.shadows = TieShadows::kFollow;
  const Registration followed = register_dates(open_in_memory(dates), kArea, 1, options);
  EXPECT_GT(followed.fit.disagreement_m.median, 3);
  for (const Tie& tie : followed.ties) EXPECT_FALSE(tie.is_confirmed);
}

/// Dark things that agree with the lit ground count, and say nothing of how well it is known.
TEST(RegisterDates, WhatIsDarkIsConfirmedByTheLitGround) {
  TwoDates dates = make_two_dates(
      kRegisteredSide_px, [](const Eigen::Vector2d&) { return Eigen::Vector2d(3, -2); }, "dark");
  // In the middle the lit ground shows nothing, and dark things, which are alike in both, all.
  for (Raster* date : {&dates.reference, &dates.second}) {
    cv::Mat middle = date->pixels(cv::Rect(330, 330, 140, 140));
    cv::Mat plain(middle.size(), CV_8U, cv::Scalar(150));
    const cv::Point moved = date == &dates.second ? cv::Point(3, 2) : cv::Point(0, 0);
    for (int i = 0; i < 140 * 140; i += 977)
      plain(cv::Rect(cv::Point(i % 125, i / 140 % 125) + moved, cv::Size(8, 8))) = 40;
    plain.copyTo(middle);
  }
  const Registration result = register_dates(open_in_memory(dates), kArea, 1, {});
  std::set<std::pair<double, double>> places;
  int confirmed = 0;
  for (const Tie& tie : result.ties) {
    if (tie.gsd_m > 1.5) continue;
    EXPECT_TRUE(places.emplace(tie.point_m.x(), tie.point_m.y()).second);  // one a place
    if (!tie.is_confirmed) continue;
    ++confirmed;
    EXPECT_LT((tie.displacement_m - Eigen::Vector2d(3, -2)).norm(), 1.2);
  }
  EXPECT_GE(confirmed, 1);
}

TEST(RegisterDates, OtherGroundIsKnownNowhereAndNoGroundIsRefused) {
  TwoDates dates = make_two_dates(kRegisteredSide_px, bent_field, "unrelated");
  dates.second.pixels = testing::random_texture(kRegisteredSide_px, "unrelated other");
  const Registration result = register_dates(open_in_memory(dates), kArea, 1, {});
  EXPECT_EQ(compare(result.fit.field, 0).known, 0);
  dates.second.valid = 0;
  EXPECT_THROW(register_dates(open_in_memory(dates), kArea, 1, {}), DataError);
}

TEST(RegisterDates, DoesNotDependOnThreads) {
  const TwoDates dates = make_two_dates(kRegisteredSide_px, bent_field, "threads");
  const OpenPair open = open_in_memory(dates);
  for (const double gsd_m : {1.0, 2.0}) {  // with shadows left out, and not
    EXPECT_EQ(register_dates(open, kArea, gsd_m, {}, {}, 1).fit.field.control_m,
              register_dates(open, kArea, gsd_m, {}, {}, 3).fit.field.control_m);
  }
}

}  // namespace
}  // namespace pilotage
