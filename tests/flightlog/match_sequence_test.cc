#include "pilotage/flightlog/match_sequence.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include "testing/textured_map.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/flightlog/fix_table.h"
#include "pilotage/flightlog/match_flight.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::TexturedGround;

/// A map of texture and frames over it, taken a second apart.
class TexturedFlight {
 public:
  TexturedFlight() { testing::write_textured_map(folder_ / "map.gpkg", ground_); }

  /// A frame taken at a place of the ground by an aircraft that is wrong by `off_m`.
  void add(double east_m, const Eigen::Vector2d& off_m) {
    const std::size_t index = frames_.size();
    const std::string name = std::to_string(index) + ".png";
    cv::imwrite((folder_ / name).string(), testing::frame_over(ground_, east_m, 0, {}, ground_.agl_m).gray);
    const LocalFrame at_center(ground_.center);
    FrameRecord row;
    row.file = name;
    row.time_s = static_cast<double>(index);
    row.prior = at_center.geodetic_from_enu({east_m + off_m.x(), off_m.y(), 0});
    row.prior_covariance_en_m2 = isotropic_covariance_m2(15);
    row.height_agl_m = ground_.agl_m;
    row.attitude = {0, 0, 0};
    row.true_nadir = at_center.geodetic_from_enu({east_m, 0, 0});
    frames_.push_back({(folder_ / name).string(), row, ground_.camera});
  }
  std::vector<FlightFrame>& frames() { return frames_; }
  OpenMaps open_maps() const { return open_unverified_maps({folder_ / "map.gpkg"}); }
  MatchedSequence match(const MatchOptions& options = {}) const {
    return match_sequence(open_maps(), frames_, options, make_ins_error_model({}), {});
  }

 private:
  TemporaryFolder folder_;
  TexturedGround ground_ = testing::make_textured_ground();
  std::vector<FlightFrame> frames_;
};

// Positions that each err on their own, by 15 m on each axis: a track of one says nothing of the next.
TEST(MatchSequence, PriorsThatAreNoDriftAreUsedAsTheyAre) {
  TexturedFlight flight;
  Random random(3);
  for (int i = 0; i < 24; ++i) flight.add(-20 + 10 * (i % 5), {15 * random.normal(), 15 * random.normal()});
  const MatchedSequence done = flight.match();
  EXPECT_TRUE(done.summary.rows_jump);
  EXPECT_THAT(rows_jump_warning(done.summary), HasSubstr("are not those of one drifting system"));
  const std::vector<FrameMatch> alone = match_flight(flight.open_maps(), flight.frames(), {}, 1, {});
  EXPECT_EQ(fix_table_to_csv(done.matches, false), fix_table_to_csv(alone, false));
  EXPECT_GE(std::count_if(alone.begin(), alone.end(), [](const FrameMatch& match) { return match.has_fix(); }), 20);
}

TEST(MatchSequence, ADriftOfTheGradeIsNoJump) {
  TexturedFlight flight;
  for (int i = 0; i < 24; ++i) flight.add(-20 + 10 * (i % 5), {12 + 0.02 * i, -9});
  const MatchedSequence done = flight.match();
  EXPECT_FALSE(done.summary.rows_jump);
  EXPECT_EQ(rows_jump_warning(done.summary), "");
  EXPECT_EQ(done.summary.narrowed, 23);
}

TEST(MatchSequence, AFixNarrowsTheNextFramesWindow) {
  TexturedFlight flight;
  for (int i = 0; i < 4; ++i) flight.add(-20 + 10 * i, {12 + 0.02 * i, -9});
  const MatchedSequence done = flight.match();
  EXPECT_EQ(done.summary.narrowed, 3);
  EXPECT_EQ(done.summary.confirmed + done.summary.gate_refusals + done.summary.resets, 0);
  for (const FrameMatch& match : done.matches) {
    ASSERT_TRUE(match.has_fix()) << match.frame.file;
    EXPECT_LT(match.error->error_m, 2) << match.frame.file;
  }
  EXPECT_NEAR(done.matches[0].result.stats.search_half_width_m, 3 * 15 + 2 * 60 * std::tan(std::numbers::pi / 180),
              1e-9);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_LT(done.matches[i].result.stats.search_half_width_m, 15);
    EXPECT_LT(
        LocalFrame(*done.matches[i].frame.true_nadir).enu_from_geodetic(done.matches[i].frame.prior).head<2>().norm(),
        3)
        << "the prior is moved by the error that the fixes tell of";
  }
}

TEST(MatchSequence, FramesAreTakenInTheOrderOfTheirTimes) {
  TexturedFlight flight;
  for (int i = 0; i < 4; ++i) flight.add(-20 + 10 * i, {12, -9});
  const MatchedSequence in_order = flight.match();
  std::reverse(flight.frames().begin(), flight.frames().end());
  MatchedSequence reversed = flight.match();
  std::reverse(reversed.matches.begin(), reversed.matches.end());
  EXPECT_EQ(fix_table_to_csv(reversed.matches, false), fix_table_to_csv(in_order.matches, false));
}

TEST(MatchSequence, WhatASequenceNeedsIsSaid) {
  TexturedFlight flight;
  flight.add(0, {1, 1});
  flight.add(0, {1, 1});
  const auto error = [&](const MatchOptions& options = {}) {
    return testing::error_of<UsageError>([&] { flight.match(options); });
  };
  MatchOptions strict;
  strict.max_false_fix_rate = 1e-6;
  EXPECT_THAT(error(strict), HasSubstr("max_false_fix_rate = 1e-06 is below 2e-06"));
  flight.frames()[1].frame.time_s = kNaN;
  EXPECT_EQ(error(), "1.png: time_s is not known, which frames in sequence need");
  EXPECT_TRUE(match_sequence(flight.open_maps(), {}, {}, make_ins_error_model({}), {}).matches.empty());
}

TEST(MatchSequence, MayBeStopped) {
  TexturedFlight flight;
  flight.add(0, {1, 1});
  flight.add(0, {1, 1});
  const auto stop = [](std::string_view, std::int64_t done, std::int64_t) { return done < 1; };
  EXPECT_THROW(match_sequence(flight.open_maps(), flight.frames(), {}, make_ins_error_model({}), stop), Interrupted);
}

}  // namespace
}  // namespace pilotage
