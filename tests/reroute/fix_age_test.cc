#include "pilotage/reroute/fix_age.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/ins/drift.h"
#include "pilotage/ins/ins_state.h"

namespace pilotage {
namespace {

FixAgeModel whole_bins() {
  FixAgeModel model;
  model.bin_m = 10;
  model.bins = 4;
  model.window_m = 10;
  return model;
}

// Four steps without a fix are one too many; a fix in the third saves its share.
TEST(FixAge, FlightsAreLostBehindTheLastBin) {
  const FixAgeModel model = whole_bins();
  FixAges ages = ages_at_start(model);
  EXPECT_EQ(share_within(model, ages), 1);
  for (int i = 0; i < 3; ++i) fly_step(model, {10, 0}, ages);
  EXPECT_EQ(share_within(model, ages), 1);
  EXPECT_EQ(ages.since_matchable_m, 30);
  FixAges lost = ages;
  fly_step(model, {10, 0}, lost);
  EXPECT_EQ(share_within(model, lost), 0);

  ages = ages_at_start(model);
  fly_step(model, {10, 0}, ages);
  fly_step(model, {10, 0}, ages);
  fly_step(model, {10, 0.25F}, ages);
  EXPECT_EQ(ages.since_matchable_m, 0);
  fly_step(model, {10, 0}, ages);
  EXPECT_FLOAT_EQ(share_within(model, ages), 0.25F);
}

// A try counts once a window, however finely the line is cut: P over one window of equal ground is P of its tile.
TEST(FixAge, StepsOfAWindowTogetherHaveItsP) {
  FixAgeModel model = whole_bins();
  model.bins = 40;
  model.start_age_m = 300;  // what had no fix stays far from what had one
  for (const int steps : {1, 2, 5}) {
    FixAges ages = ages_at_start(model);
    for (int i = 0; i < steps; ++i) fly_step(model, {10.0F / static_cast<float>(steps), 0.6F}, ages);
    EXPECT_NEAR(ages.within[20], 0.6, 1e-6) << steps;
    EXPECT_NEAR(share_within(model, ages), 1, 1e-6) << steps;
  }
}

// What the proof of dominance rests on: flights that are better off stay so, whatever is flown.
TEST(FixAge, KeepsTheOrderOfFlights) {
  Random random(seed_from_name("order of flights"));
  FixAgeModel model = whole_bins();
  model.bins = 12;
  for (int trial = 0; trial < 200; ++trial) {
    FixAges worse;
    FixAges better;
    float low = 0;
    float high = 0;
    for (std::size_t bin = 0; bin < model.bins; ++bin) {
      low += static_cast<float>(random.uniform(0, 1.0 / 12));
      high = std::max(high, low + static_cast<float>(random.uniform(0, 0.05)));
      worse.within[bin] = low;
      better.within[bin] = high;
    }
    for (int step = 0; step < 20; ++step) {
      const FlownStep flown{static_cast<float>(random.uniform(0, 35)),
                            random.uniform() < 0.5 ? 0.0F : static_cast<float>(random.uniform())};
      fly_step(model, flown, worse);
      fly_step(model, flown, better);
      for (std::size_t bin = 0; bin < model.bins; ++bin) ASSERT_GE(better.within[bin], worse.within[bin]);
    }
  }
}

// The reach of the model is that of the inertial model after fixes, and the loss of GNSS leaves less of it.
TEST(FixAge, ReachIsThatOfTheInertialModel) {
  InsOptions options;
  options.grade = InsGrade::kConsumer;
  const InsErrorModel ins = make_ins_error_model(options);
  const FixAgeModel model = make_fix_age_model(ins, 15, 50, 0.8, 100, 10, 3);
  InsState state = initial_ins_state(ins, 0, 15);
  for (int i = 0; i < 3; ++i) state = update_with_fix(propagate(state, 100.0 / 15, 0, 15, ins), ins.fix_sigma_m);
  const double reach_m = model.bin_m * static_cast<double>(model.bins);
  const auto error_m = [&](double way_m) {
    return position_error_m(propagate(state, way_m / 15, 0, 15, ins), ins.sigma_multiple);
  };
  EXPECT_LE(error_m(reach_m), 50);
  EXPECT_GT(error_m(reach_m + model.bin_m), 50);
  EXPECT_NEAR(error_m(model.good_reach_m), 40, 0.1);
  const double from_start_m = longest_bridgeable_gap_s(ins, 15, 50, ins.sigma_multiple, ins.start_sigma_m) * 15;
  EXPECT_GT(model.start_age_m, 0);
  EXPECT_NEAR(model.start_age_m + from_start_m, reach_m, model.bin_m + 1);
}

}  // namespace
}  // namespace pilotage
