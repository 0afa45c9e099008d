#include "pilotage/landmark/detections.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(Detections, AveragePrecisionByHand) {
  EXPECT_DOUBLE_EQ(average_precision({{3, true}, {2, true}}, 2), 1);
  // Precision 1, 1/2, 2/3 at recall 1/2, 1/2, 1: 1/2 · 1 + 1/2 · 2/3.
  EXPECT_DOUBLE_EQ(average_precision({{3, true}, {2, false}, {1, true}}, 2), 0.5 + 1.0 / 3);
  // A later, better precision counts for what came before: 1/2, 2/3, 3/4.
  EXPECT_DOUBLE_EQ(average_precision({{4, false}, {3, true}, {2, true}, {1, true}}, 3), 0.75);
  EXPECT_DOUBLE_EQ(average_precision({{3, true}}, 4), 0.25);
  EXPECT_DOUBLE_EQ(average_precision({}, 4), 0);
  EXPECT_TRUE(std::isnan(average_precision({}, 0)));
  // Nothing is gained where scores are equal.
  EXPECT_DOUBLE_EQ(average_precision({{1, true}, {1, false}}, 1), 0.5);
}

TEST(Detections, BestThresholdWeighsBoth) {
  // F1: 2/4 from 3, 4/6 from 2 (2 of 3 right at 1), 6/7 from 1 on.
  EXPECT_EQ(best_threshold({{4, true}, {3, true}, {2, false}, {1, true}}, 3), 1);
  EXPECT_EQ(best_threshold({{4, true}, {3, false}, {2, false}, {1, true}}, 1), 4);
  EXPECT_EQ(best_threshold({{4, false}}, 3), std::numeric_limits<double>::infinity());
  // A score is in or out as a whole.
  EXPECT_EQ(best_threshold({{2, true}, {1, true}, {1, false}}, 2), 1);
}

}  // namespace
}  // namespace pilotage
