#include "pilotage/simulate/simulate_flights.h"

#include "select/straight_mission.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/select/select_tiles.h"

namespace pilotage {
namespace {

using testing::good_scores;
using testing::kStoredSize;
using testing::straight_mission;

/// Nothing but what the plan knows of.
SimulateOptions as_planned(std::int64_t flights) {
  SimulateOptions options;
  options.flights = flights;
  options.map_sigma_m = 0;
  options.wind_sigma_mps = 0;
  options.false_fix_rate = 0;
  return options;
}

struct Case {
  Mission mission;
  std::vector<TileScores> scores;
  Selection selection;

  Simulation fly(const SimulateOptions& options, std::uint64_t seed = 1, int threads = 0) const {
    return simulate_flights(mission, scores, selection, options, seed, threads, {});
  }
};

Case case_of(double p, double level_sigma = 0, double length_m = 4000, double half_width_m = 100) {
  Case made{straight_mission(length_m, half_width_m, 2), {}, {}};
  made.mission.flight.ins.grade = InsGrade::kIndustrial;
  made.scores = good_scores(made.mission);
  for (TileScores& score : made.scores) {
    score.p_correct_fix = p;
    score.level_sigma = level_sigma;
  }
  made.selection = select_tiles(made.mission, made.scores, kStoredSize, {});
  return made;
}

TEST(SimulateFlights, AgreesWithThePlanInWhatThePlanKnows) {
  for (const double level_sigma : {0.0, 1.0}) {
    const Case made = case_of(0.35, level_sigma);
    const Simulation found = made.fly(as_planned(1000));
    EXPECT_EQ(found.planned_p, made.selection.probability->p_within_limit);
    EXPECT_GT(found.planned_p, 0.05);
    EXPECT_LT(found.planned_p, 0.95);
    // The true error and the strip take a little away, so the interval is widened by one point.
    EXPECT_GE(found.planned_p, found.within_sure.interval.low - 0.01) << level_sigma;
    EXPECT_LE(found.planned_p, found.within_sure.interval.high + 0.01) << level_sigma;
    ASSERT_EQ(found.legs.size(), 2U);
    EXPECT_EQ(found.legs[0].planned_p, made.selection.legs[0].p_within_limit);
    EXPECT_EQ(found.legs[0].within.of, 1000);
    EXPECT_EQ(found.legs[1].within.of, found.legs[0].within.count);
    EXPECT_EQ(found.legs[1].within.count, found.within.count);
  }
}

TEST(SimulateFlights, FixesComeFromTheSourceThatIsGiven) {
  const Case made = case_of(0.35);
  const SimulateOptions options = as_planned(40);
  FixSource source;
  source.notes = {"perfect"};
  source.not_simulated = {"errors"};
  source.begin_flight = [](std::size_t, std::uint64_t, int, const std::function<bool()>&) -> FlightFixes {
    return [](const FixTry& tried) {
      const Eigen::Vector2d expected = tried.drawn->errors.head<2>() + tried.drawn->errors.tail<2>();
      return TriedFix{true, OfferedFix{expected, Eigen::Matrix2d::Identity(), true}};
    };
  };
  const Simulation perfect = simulate_flights(made.mission, made.scores, made.selection, options, 1, 2, {}, source);
  EXPECT_EQ(perfect.within.count, 40);
  ASSERT_EQ(perfect.by_p.size(), 1U);
  EXPECT_NEAR(perfect.by_p[0].mean_p, 0.35, 1e-12);
  EXPECT_EQ(perfect.by_p[0].found.count, perfect.by_p[0].found.of);
  EXPECT_GT(perfect.by_p[0].found.of, 100);
  EXPECT_EQ(perfect.fixes.missed, 0);
  EXPECT_EQ(perfect.notes, std::vector<std::string>{"perfect"});
  EXPECT_EQ(perfect.not_simulated.front(), "errors");

  const Simulation drawn = made.fly(as_planned(400));
  ASSERT_EQ(drawn.by_p.size(), 1U);
  EXPECT_NEAR(drawn.by_p[0].found.share(), 0.35, 0.03);
}

TEST(SimulateFlights, WithoutFixesTheInertialSystemIsAlone) {
  const Case made = case_of(0.9);
  SimulateOptions options = as_planned(100);
  options.fixes = FixesFrom::kNone;
  const Simulation none = made.fly(options);
  EXPECT_EQ(none.fixes.right + none.fixes.missed, 0);
  EXPECT_EQ(none.fixes.no_frame, none.fixes.tries);
  EXPECT_TRUE(none.by_p.empty());
  EXPECT_LT(none.within.count, made.fly(as_planned(100)).within.count);
  options.fixes = FixesFrom::kRendered;
  EXPECT_THROW(made.fly(options), UsageError);
}

TEST(SimulateFlights, AFlightHasOneLevel) {
  // If each tile met its own level, fixes would be as many and flights would be lost less often.
  const double shared = case_of(0.5, 3).fly(as_planned(1000)).within.share();
  const double alone = case_of(0.5, 0).fly(as_planned(1000)).within.share();
  EXPECT_LT(shared, alone - 0.1);
}

TEST(SimulateFlights, SameBytesForAnyNumberOfThreads) {
  const Case made = case_of(0.5, 1);
  SimulateOptions options;
  options.flights = 150;
  const Simulation one = made.fly(options, 7, 1);
  const Simulation many = made.fly(options, 7, 4);
  const Simulation other = made.fly(options, 8, 4);
  EXPECT_EQ(one.within.count, many.within.count);
  EXPECT_EQ(one.fixes.right, many.fixes.right);
  EXPECT_EQ(one.marks.back().cep50_m, many.marks.back().cep50_m);
  EXPECT_EQ(one.marks.back().nees, many.marks.back().nees);
  EXPECT_NE(one.marks.back().nees, other.marks.back().nees);
}

TEST(SimulateFlights, SureFixesKeepEveryFlight) {
  const Simulation found = case_of(1).fly(as_planned(200));
  EXPECT_EQ(found.within.count, 200);
  EXPECT_EQ(found.fixes.missed, 0);
  EXPECT_EQ(found.fixes.right + found.fixes.refused, found.fixes.tries);
  EXPECT_LT(found.fixes.refused, found.fixes.tries / 200) << "the gate refuses one right fix in a thousand";
  EXPECT_LT(found.marks.back().r95_m, 10);
  EXPECT_EQ(found.marks.size(), 4U);
  EXPECT_EQ(found.marks.back().distance_m, 4000);
}

TEST(SimulateFlights, NoStoredGroundLosesEveryFlight) {
  Case made = case_of(0.5);
  made.selection.tile_ids.clear();
  const Simulation found = made.fly(as_planned(100));
  EXPECT_EQ(found.within.count, 0);
  EXPECT_EQ(found.planned_p, 0);
  EXPECT_EQ(found.fixes.right, 0);
  EXPECT_EQ(found.marks.back().lost, 0) << "all were lost before";
  EXPECT_EQ(found.legs[1].within.of, 0);
  EXPECT_TRUE(std::isnan(found.legs[1].within.share()));
}

TEST(SimulateFlights, BesideTheStripThereIsNoFix) {
  // One row of tiles, half of them never found: in the gaps the aircraft drifts off the strip.
  Case made = case_of(0.3, 0, 4000, 20);
  made.mission.flight.max_error_m = made.selection.max_error_m = 300;
  const Simulation found = made.fly(as_planned(1000));
  EXPECT_GT(found.fixes.off_line, 0);
  EXPECT_LT(found.within.share(), found.planned_p);
}

TEST(SimulateFlights, GnssIsLostWhereItIsSaid) {
  const Case made = case_of(0.35);
  SimulateOptions options = as_planned(500);
  const double all_the_way = made.fly(options).within.share();
  options.lost_from_km = 3.5;
  const Simulation late = made.fly(options);
  EXPECT_NEAR(late.lost_from_m, 3500, 10);
  EXPECT_GT(late.within.share(), all_the_way);
  EXPECT_LT(late.marks[2].r95_m, 10) << "with GNSS";
  options.lost_from_km = 4;
  EXPECT_THROW(made.fly(options), UsageError);
}

TEST(SimulateFlights, FalseFixesAndWindDoHarm) {
  const Case made = case_of(0.35);
  SimulateOptions options = as_planned(1000);
  options.false_fix_rate = 0.5;
  const Simulation deceived = made.fly(options);
  EXPECT_GT(deceived.fixes.false_taken, 100);
  EXPECT_GT(deceived.marks.back().nees, deceived.marks.back().nees_band.high);
  EXPECT_GT(deceived.unaware.count, 0);
  options = as_planned(1000);
  options.wind_sigma_mps = 8;
  EXPECT_LT(made.fly(options).within.share(), made.fly(as_planned(1000)).within.share());
}

TEST(SimulateFlights, FilterIsHonestWithAnErrorOfTheMap) {
  SimulateOptions options = as_planned(1000);
  options.map_sigma_m = 4;
  for (const SimulatedMark& mark : case_of(0.8).fly(options).marks) {
    EXPECT_GT(mark.nees, mark.nees_band.low - 0.05) << mark.distance_m;
    EXPECT_LT(mark.nees, mark.nees_band.high + 0.05) << mark.distance_m;
  }
}

TEST(SimulateFlights, ASelectionWithoutItsTriesIsRefused) {
  Case made = case_of(0.5);
  made.selection.tries.reset();
  EXPECT_THROW(made.fly(as_planned(1)), DataError);
}

}  // namespace
}  // namespace pilotage
