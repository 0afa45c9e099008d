#include "pilotage/registration/feature_fates.h"

#include <algorithm>

#include "registration/two_dates.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace pilotage {
namespace {

constexpr int kFatesSide_px = 1100;  // three blocks a side
constexpr int kChanged_px = 700;
constexpr int kNoGround_px = 900;
const std::vector<PixelWindow> kAll{{0, 0, kFatesSide_px, kFatesSide_px}};

// The second date shows other ground from column 700 on, and none from row 900 on.
testing::TwoDates dates() {
  testing::TwoDates dates = testing::make_two_dates(
      kFatesSide_px, [](const Eigen::Vector2d&) { return Eigen::Vector2d(0, 0); }, "fates");
  const cv::Rect changed(kChanged_px, 0, kFatesSide_px - kChanged_px, kFatesSide_px);
  testing::random_texture(kFatesSide_px, "elsewhere")(changed).copyTo(dates.second.pixels(changed));
  dates.second.valid.rowRange(kNoGround_px, kFatesSide_px) = 0;
  return dates;
}

class FeatureFates : public ::testing::Test {
 protected:
  testing::TwoDates dates_ = dates();
  GraySource reference_ = gray_source_from(dates_.reference);
  GraySource second_ = gray_source_from(dates_.second);
};

TEST_F(FeatureFates, TellWhatStayedFromWhatChangedAndWhatIsNotShown) {
  FeatureOptions options;
  options.octaves = 2;
  const FeatureSet found = extract_features_of_map(reference_, kAll, options);
  const std::vector<FeatureFate> fates = feature_fates(found, second_, options);
  ASSERT_EQ(fates.size(), found.size());
  int stayed = 0;
  int changed = 0;
  int changed_and_survived = 0;
  int not_shown = 0;
  for (std::size_t i = 0; i < fates.size(); ++i) {
    const Feature& feature = found.features[i];
    const double reach = (descriptor_of(options).reach_px + 1) * (feature.octave == 0 ? 1 : options.scale_factor) + 1.5;
    if (static_cast<double>(feature.y_px) + reach > kNoGround_px + 1) {
      ++not_shown;
      EXPECT_EQ(fates[i], FeatureFate::kNotKnown) << feature.x_px << ", " << feature.y_px;
      continue;
    }
    const double nearest_edge =
        static_cast<double>(std::min({feature.x_px, feature.y_px, kFatesSide_px - feature.x_px}));
    if (static_cast<double>(feature.y_px) + reach > kNoGround_px - 2 || nearest_edge < reach + 2) continue;
    EXPECT_NE(fates[i], FeatureFate::kNotKnown) << feature.x_px << ", " << feature.y_px;
    if (static_cast<double>(feature.x_px) + 2 * reach < kChanged_px) {
      ++stayed;
      EXPECT_EQ(fates[i], FeatureFate::kSurvives) << feature.x_px << ", " << feature.y_px;
    } else if (feature.x_px > kChanged_px + 20) {
      ++changed;
      if (fates[i] == FeatureFate::kSurvives) ++changed_and_survived;
    }
  }
  EXPECT_GT(stayed, 5000);
  EXPECT_GT(changed, 2000);
  EXPECT_GT(not_shown, 1000);
  EXPECT_LT(changed_and_survived, changed / 20) << "smooth texture resembles itself now and then";
}

TEST_F(FeatureFates, DependNeitherOnWindowsNorOnThreads) {
  const FeatureSet all = extract_features_of_map(reference_, kAll, {});
  const std::vector<FeatureFate> of_all = feature_fates(all, second_, {}, 1);
  EXPECT_EQ(feature_fates(all, second_, {}, 3), of_all);
  const std::vector<PixelWindow> part{{600, 450, 200, 500}};
  const FeatureSet few = extract_features_of_map(reference_, part, {});
  const std::vector<FeatureFate> of_few = feature_fates(few, second_, {}, 2);
  ASSERT_GT(few.size(), 500U);
  std::size_t i = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool same =
        i < few.size() && all.features[k].x_px == few.features[i].x_px && all.features[k].y_px == few.features[i].y_px;
    if (!same) continue;
    EXPECT_EQ(of_all[k], of_few[i]);
    ++i;
  }
  EXPECT_EQ(i, few.size());
  EXPECT_TRUE(feature_fates({}, second_, {}).empty());
}

}  // namespace
}  // namespace pilotage
