#include "pilotage/tile/working_gsd.h"

#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

TEST(WorkingGsd, MakesTheFootprint256PxWideWithinHalfToOneMetre) {
  EXPECT_DOUBLE_EQ(choose_working_gsd({}, 0.15, 0.05, 153.6).gsd_m, 0.6);
  EXPECT_DOUBLE_EQ(choose_working_gsd({}, 0.15, 0.05, 138.9).gsd_m, 0.55);
  EXPECT_DOUBLE_EQ(choose_working_gsd({}, 0.15, 0.05, 50).gsd_m, 0.5);
  EXPECT_DOUBLE_EQ(choose_working_gsd({}, 0.15, 0.05, 2000).gsd_m, 1.0);
}

TEST(WorkingGsd, IsNeverFinerThanImageryOrCamera) {
  EXPECT_DOUBLE_EQ(choose_working_gsd({}, 10, 0.05, 150).gsd_m, 10);
  EXPECT_DOUBLE_EQ(choose_working_gsd({}, 0.3, 1.7, 2000).gsd_m, 1.7);
}

TEST(WorkingGsd, WhatIsAskedForHoldsUnlessItInventsDetail) {
  EXPECT_DOUBLE_EQ(choose_working_gsd(0.3, 0.3, 0.05, 150).gsd_m, 0.3);
  EXPECT_DOUBLE_EQ(choose_working_gsd(0.299, 0.3, 0.05, 150).gsd_m, 0.299);  // within the scale distortion of a raster
  EXPECT_THROW(choose_working_gsd(0.2, 0.3, 0.05, 150), UsageError);
}

}  // namespace
}  // namespace pilotage
