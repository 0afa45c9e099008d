#include "pilotage/matchability/reasons.h"

#include <numeric>

#include "testing/color_source_from.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/matchability/ground_cover.h"
#include "pilotage/matchability/self_votes.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ReasonContext context_of(int tile_size_px = 256, double gsd_m = 0.6) {
  ReasonContext context;
  context.matrix = {0, GeoTransform::north_up(500000, 5'000'000, gsd_m), 4000, 4000, tile_size_px, 64};
  context.min_agl_m = 100;
  return context;
}

/// A tile that nothing speaks against but its P.
TileScores good_tile(double p = 0.3) {
  TileScores score;
  score.valid_fraction = 1;
  score.p_correct_fix = p;
  score.gray_variance = 40;
  score.frieden_deficit = 0.2;
  score.map_features = 600;
  score.vote_noise = 2;
  score.clean.rival_ratio = 0.4;
  score.vegetation_share = 0.2;
  score.water_share = 0;
  score.aperture = 0.7;
  score.relief_m = 5;
  return score;
}

std::vector<ReasonCode> codes(const TileScores& score, const ReasonContext& context = context_of()) {
  std::vector<ReasonCode> list;
  for (const Reason& reason : tile_reasons(score, context)) list.push_back(reason.code);
  return list;
}

std::string text(const TileScores& score, const ReasonContext& context = context_of()) {
  return reasons_text(tile_reasons(score, context));
}

TEST(Reasons, NoneWhereNothingIsWrong) {
  EXPECT_THAT(codes(good_tile(0.9)), IsEmpty());
  EXPECT_THAT(codes(good_tile(0.7)), IsEmpty());
  TileScores unknown;
  unknown.valid_fraction = 1;
  EXPECT_THAT(codes(unknown), IsEmpty()) << "what was not measured is no reason";
}

TEST(Reasons, LowPAlwaysHasOne) {
  EXPECT_THAT(codes(good_tile()), ElementsAre(ReasonCode::kWeak));
  EXPECT_THAT(text(good_tile()), HasSubstr("600 features against a noise of 2.0 votes"));
}

TEST(Reasons, TooLittleGroundAndFlatStandAlone) {
  TileScores score = good_tile();
  score.status = TileStatus::kTooLittleGround;
  score.valid_fraction = 0.31;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kTooLittleGround));
  EXPECT_EQ(text(score), "The imagery covers only 31 % of the tile.");
  score.status = TileStatus::kFlat;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kFlat));
  score = good_tile();
  score.valid_fraction = 0.6;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kTooLittleGround));
}

TEST(Reasons, LowContrast) {
  TileScores score = good_tile();
  score.frieden_deficit = 0.05 * 0.05;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kFlat));
  EXPECT_THAT(text(score), HasSubstr("by 5 % of their mean"));
  score.frieden_deficit = -1e-9;  // rounding
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kFlat));
}

TEST(Reasons, FewFeatures) {
  TileScores score = good_tile();
  score.map_features = 14;
  score.vote_noise = 0.01;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kFewFeatures));
  EXPECT_THAT(text(score), HasSubstr("Only 14 features"));
  score.map_features = 0;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kFewFeatures));
}

TEST(Reasons, RepeatsSayWhere) {
  TileScores score = good_tile();
  score.clean.rival_ratio = 0.91;
  score.clean.rival_dx_px = 100;
  score.clean.rival_dy_px = -98;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kRepeats));
  EXPECT_EQ(text(score), "Looks like the ground 84 m to the north-east (correlation there 91 % of its own).");
  score.clean.rival_dx_px = -100;
  score.clean.rival_dy_px = 3;
  EXPECT_THAT(text(score), HasSubstr("60 m to the west"));
  score.clean.rival_dx_px = 2;
  score.clean.rival_dy_px = 100;
  EXPECT_THAT(text(score), HasSubstr("60 m to the south "));
  ReasonContext degrees = context_of();
  degrees.metres_per_unit = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(text(score, degrees), HasSubstr("100 px to the south"));
  score.clean.rival_ratio = 1;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kRepeats));
}

TEST(Reasons, FeaturesThatLookAlike) {
  TileScores score = good_tile();
  score.vote_noise = 48;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kRepeats));
  EXPECT_THAT(text(score), HasSubstr("8.0 votes for every hundred"));
}

TEST(Reasons, VegetationWaitsForTheSecondDate) {
  TileScores score = good_tile();
  score.vegetation_share = 0.9;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kVegetation));
  EXPECT_THAT(text(score), HasSubstr("90 % of it is green"));
  score.p_correct_fix = 0.7;
  EXPECT_THAT(codes(score), IsEmpty()) << "a suspicion is told of a low P only";
  score.p_correct_fix = 0.3;
  score.epoch.margin = 0.4;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kWeak)) << "it was seen to stay";
  score.epoch.margin = -0.1;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kVegetation, ReasonCode::kChanged));
  EXPECT_THAT(text(score), HasSubstr("margin -0.10"));
}

TEST(Reasons, WaterEdgesReliefAndPixels) {
  TileScores score = good_tile();
  score.water_share = 0.73;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kWater));
  EXPECT_THAT(text(score), HasSubstr("73 % of it looks like open water"));
  score = good_tile();
  score.aperture = 0.06;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kEdgeOnly));
  score = good_tile();
  score.relief_m = 31;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kRelief));
  EXPECT_THAT(text(score), HasSubstr("31 m, 31 % of the 100 m"));
  ReasonContext unknown_height = context_of();
  unknown_height.min_agl_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(codes(score, unknown_height), ElementsAre(ReasonCode::kWeak));
  EXPECT_THAT(codes(good_tile(), context_of(64)), ElementsAre(ReasonCode::kCoarse));
  EXPECT_THAT(text(good_tile(), context_of(64)), HasSubstr("64 x 64 pixels of 0.60 m of the map"));
}

TEST(Reasons, Changed) {
  TileScores score = good_tile();
  score.epoch.survival = 0.02;
  score.epoch.margin = 0.3;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kChanged));
  EXPECT_THAT(text(score), HasSubstr("only 2 % of its features"));
}

TEST(Reasons, TheHeaviestThreeInOrder) {
  TileScores score = good_tile();
  score.water_share = 0.105;     // a little over 0.1
  score.aperture = 0.01;         // far below
  score.vegetation_share = 0.9;  // a little over 0.8
  score.map_features = 20;       // far below
  score.vote_noise = 0.1;
  const std::vector<Reason> reasons = tile_reasons(score, context_of());
  ASSERT_EQ(reasons.size(), 3U);
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kEdgeOnly, ReasonCode::kFewFeatures, ReasonCode::kWater));
  EXPECT_GE(reasons[0].weight, reasons[1].weight);
  EXPECT_GE(reasons[1].weight, reasons[2].weight);
}

TEST(Reasons, TheWatchListTellsOnlyWhatIsPlain) {
  TileScores score = good_tile(0.3);
  score.water_share = 0.087;  // 0.87 of the threshold
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kWater));
  score.p_correct_fix = 0.7;
  EXPECT_THAT(codes(score), IsEmpty());
  score.water_share = 0.5;
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kWater));
  score.p_correct_fix = 0.85;
  EXPECT_THAT(codes(score), IsEmpty());
  score.p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(codes(score), ElementsAre(ReasonCode::kWater)) << "without a model P is not known";
}

/// Ground made of copies of one patch: what is measured of it must give the reason.
TEST(Reasons, ALatticeRepeats) {
  constexpr int kSide = 512;
  constexpr int kPeriod = 40;
  Random random(seed_from_name("ALatticeRepeats"));
  cv::Mat patch(kPeriod, kPeriod, CV_32F);
  for (int i = 0; i < kPeriod * kPeriod; ++i)
    patch.at<float>(i / kPeriod, i % kPeriod) = static_cast<float>(random.uniform());
  cv::Mat noise;
  cv::repeat(patch, kSide / kPeriod + 1, kSide / kPeriod + 1, noise);
  cv::GaussianBlur(noise, noise, {}, 2);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  cv::Mat gray;
  noise(cv::Rect(0, 0, kSide, kSide)).convertTo(gray, CV_8U);
  const Raster raster{gray, cv::Mat(gray.size(), CV_8U, cv::Scalar(255)), {}};
  ReasonContext context = context_of();
  context.matrix.grid_width_px = context.matrix.grid_height_px = kSide;
  const std::vector<std::int64_t> tile{context.matrix.matrix_width() + 1};
  const SelfVotes votes = count_self_votes(gray_source_from(raster), context.matrix, tile, {}).front();
  TileScores score = good_tile();
  score.map_features = static_cast<double>(votes.features);
  score.vote_noise = votes.noise;
  score.aperture = measure_ground_cover(testing::color_source_from(raster), context.matrix, tile).front().aperture;
  EXPECT_EQ(tile_reasons(score, context).front().code, ReasonCode::kRepeats) << votes.noise << " of " << votes.features;
  EXPECT_GT(score.aperture, 0.3);
}

}  // namespace
}  // namespace pilotage
