#include "pilotage/score/score_second_epoch.h"

#include <cmath>

#include "registration/two_dates.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/registration/register_dates.h"

namespace pilotage {
namespace {

using testing::make_two_dates;
using testing::TwoDates;

constexpr int kSide_px = 700;
const cv::Rect kChanged(400, 400, 300, 300);  // of the second date

Eigen::Vector2d field(const Eigen::Vector2d& p) {
  return {6 + 4 * std::sin((p.x() - 1000) / 200), -5 + (5000 - p.y()) / 200};
}

TwoDates half_changed() {
  TwoDates dates = make_two_dates(kSide_px, field, "epochs");
  testing::random_texture(kSide_px, "other")(kChanged).copyTo(dates.second.pixels(kChanged));
  return dates;
}

struct Scored {
  GridLevel level;
  std::vector<std::int64_t> indices;
  std::vector<EpochScores> scores;
};

Scored score(const TwoDates& dates, int threads = 1) {
  const WarpField warp =
      register_dates(testing::open_in_memory(dates), {1000, 4300, 1700, 5000}, 1, {}, {}, threads).fit.field;
  Scored scored;
  scored.level.matrix = {0, dates.reference.map_from_pixel, kSide_px, kSide_px, 100, 50};
  scored.level.search_radius_px = 40;
  for (std::int64_t i = 0; i < scored.level.matrix.tile_count(); ++i) scored.indices.push_back(i);
  scored.scores = score_epoch_tiles({gray_source_from(dates.reference), gray_source_from(dates.second)}, warp,
                                    scored.level, scored.indices, 0.5, threads);
  return scored;
}

TEST(ScoreSecondEpoch, TellsWhatStayedFromWhatChanged) {
  const Scored scored = score(half_changed());
  int stayed = 0;
  int changed = 0;
  for (std::size_t i = 0; i < scored.scores.size(); ++i) {
    const TileMatrix& matrix = scored.level.matrix;
    const PixelWindow tile = matrix.tile_window(matrix.cell_of(scored.indices[i]));
    const EpochScores& score = scored.scores[i];
    if (tile.col < 50 || tile.row < 50 || tile.col > 550 || tile.row > 550) continue;
    const Eigen::Vector2d center(1000.0 + static_cast<double>(tile.col) + 50,
                                 5000.0 - static_cast<double>(tile.row) - 50);
    if (tile.col + 100 < 380 || tile.row + 100 < 380) {
      ++stayed;
      EXPECT_GT(score.ncc, 0.95);
      EXPECT_GT(score.margin, 0.3);
      EXPECT_GT(score.survival, 0.5);
      EXPECT_NEAR(score.disagreement_m, field(center).norm(), 0.5);
    } else if (tile.col > 420 && tile.row > 420) {
      ++changed;
      if (std::isnan(score.ncc)) continue;  // the field need not be known there
      EXPECT_LT(score.ncc, 0.6);
      EXPECT_LT(score.margin, 0.3);
      EXPECT_LT(score.survival, 0.1);
    }
  }
  EXPECT_GT(stayed, 50);
  EXPECT_GT(changed, 5);
}

TEST(ScoreSecondEpoch, LeavesOutWhatHasNoGround) {
  TwoDates dates = make_two_dates(kSide_px, field, "no ground");
  dates.second.valid(cv::Rect(0, 0, 350, kSide_px)) = 0;
  const Scored scored = score(dates);
  for (std::size_t i = 0; i < scored.scores.size(); ++i) {
    const std::int64_t left = scored.level.matrix.cell_of(scored.indices[i]).column * 50;
    const EpochScores& score = scored.scores[i];
    if (left <= 200) {
      EXPECT_TRUE(std::isnan(score.ncc) && std::isnan(score.margin) && std::isnan(score.survival)) << i;
    }
    if (left >= 400 && left <= 550 && i > 30 && i < 120) {
      EXPECT_GT(score.ncc, 0.9) << i;
      EXPECT_FALSE(std::isnan(score.survival)) << i;
    }
  }
}

TEST(ScoreSecondEpoch, DoesNotDependOnThreads) {
  const TwoDates dates = half_changed();
  const Scored one = score(dates, 1);
  const Scored three = score(dates, 3);
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t i = 0; i < one.scores.size(); ++i) {
    EXPECT_TRUE(same(one.scores[i].ncc, three.scores[i].ncc)) << i;
    EXPECT_TRUE(same(one.scores[i].margin, three.scores[i].margin)) << i;
    EXPECT_TRUE(same(one.scores[i].survival, three.scores[i].survival)) << i;
    EXPECT_TRUE(same(one.scores[i].disagreement_m, three.scores[i].disagreement_m)) << i;
  }
}

}  // namespace
}  // namespace pilotage
