#include "pilotage/simulate/simulate_flights.h"

#include "select/straight_mission.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/simulate/flight_tracks.h"

namespace pilotage {
namespace {

using testing::good_scores;
using testing::kStoredSize;
using testing::straight_mission;

/// In calm, by a map without error.
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
    EXPECT_GE(found.planned_p, found.within_sure.interval().low - 0.01) << level_sigma;
    EXPECT_LE(found.planned_p, found.within_sure.interval().high + 0.01) << level_sigma;
    ASSERT_EQ(found.legs.size(), 2U);
    EXPECT_EQ(found.legs[0].planned_p, made.selection.legs[0].p_within_limit);
    EXPECT_EQ(found.legs[0].within.of, 1000);
    EXPECT_EQ(found.legs[1].within.of, found.legs[0].within.count);
    EXPECT_EQ(found.legs[1].within.count, found.within.count);
  }
}

TEST(SimulateFlights, AgreesWithThePlanInItsConditions) {
  for (const double level_sigma : {0.0, 1.0}) {
    Case made = case_of(0.35, level_sigma);
    const double calm = made.selection.probability->p_within_limit;
    made.mission.flight.conditions = {6, 3, 300, 0.05};
    made.selection = select_tiles(made.mission, made.scores, kStoredSize, {});
    SimulateOptions options;
    options.flights = 2000;
    const Simulation found = made.fly(options);
    EXPECT_FALSE(found.as_planned) << "no other conditions were asked for";
    EXPECT_EQ(found.planned_p, made.selection.probability->p_within_limit);
    EXPECT_LT(found.planned_p, calm - 0.05) << "wind, the map's error and dropped frames cost";
    EXPECT_GE(found.planned_p, found.within.interval().low - 0.03) << level_sigma;
    EXPECT_LE(found.planned_p, found.within.interval().high + 0.03) << level_sigma;
    EXPECT_GT(found.fixes.no_frame, 0);
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
  EXPECT_NEAR(drawn.by_p[0].found.value(), 0.35, 0.03);
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
  const double shared = case_of(0.5, 3).fly(as_planned(1000)).within.value();
  const double alone = case_of(0.5, 0).fly(as_planned(1000)).within.value();
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
  EXPECT_EQ(found.marks.size(), 40U);
  EXPECT_EQ(found.marks.front().distance_m, 100);
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
  EXPECT_TRUE(std::isnan(found.legs[1].within.value()));
}

TEST(SimulateFlights, BesideTheStripThereIsNoFix) {
  // One row of tiles, half of them never found: in the gaps the aircraft drifts off the strip.
  Case made = case_of(0.3, 0, 4000, 20);
  made.mission.flight.max_error_m = made.selection.max_error_m = 300;
  const Simulation found = made.fly(as_planned(1000));
  EXPECT_GT(found.fixes.off_line, 0);
  EXPECT_LT(found.within.value(), found.planned_p);
}

TEST(SimulateFlightsThorough, GnssIsLostWhereItIsSaid) {
  const Case made = case_of(0.35);
  SimulateOptions options = as_planned(500);
  const double all_the_way = made.fly(options).within.value();
  options.lost_from_km = 3.5;
  const Simulation late = made.fly(options);
  EXPECT_NEAR(late.lost_from_m, 3500, 10);
  EXPECT_GT(late.within.value(), all_the_way);
  EXPECT_LT(late.marks[29].r95_m, 10) << "with GNSS";
  options.lost_from_km = 4;
  EXPECT_THROW(made.fly(options), UsageError);
}

TEST(SimulateFlightsThorough, FalseFixesAndWindDoHarm) {
  const Case made = case_of(0.35);
  SimulateOptions options = as_planned(1000);
  options.false_fix_rate = 0.5;
  const Simulation deceived = made.fly(options);
  EXPECT_GT(deceived.fixes.false_taken, 100);
  EXPECT_GT(deceived.marks.back().nees, deceived.marks.back().nees_band.high);
  EXPECT_GT(deceived.unaware.count, 0);
  options = as_planned(1000);
  options.wind_sigma_mps = 8;
  EXPECT_LT(made.fly(options).within.value(), made.fly(as_planned(1000)).within.value());
}

TEST(SimulateFlights, FilterIsHonestWithAnErrorOfTheMap) {
  SimulateOptions options = as_planned(1000);
  options.map_sigma_m = 4;
  const std::vector<SimulatedMark> marks = case_of(0.8).fly(options).marks;
  double sum = 0;
  int outside = 0;
  for (const SimulatedMark& mark : marks) {
    sum += mark.nees;
    outside += mark.nees > mark.nees_band.low && mark.nees < mark.nees_band.high ? 0 : 1;
  }
  EXPECT_NEAR(sum / static_cast<double>(marks.size()), 2, 0.05);
  EXPECT_LE(outside, 8) << "of " << marks.size() << ", of which two are expected; neighbours are alike";
}

TEST(SimulateFlights, ASelectionWithoutItsTriesIsRefused) {
  Case made = case_of(0.5);
  made.selection.tries.reset();
  EXPECT_THROW(made.fly(as_planned(1)), DataError);
}

TEST(SimulateFlights, SaysWhatOtherConditionsThanThePlansCost) {
  const Case made = case_of(0.35);
  const Simulation calm = made.fly(as_planned(400));
  EXPECT_EQ(calm.as_planned->within.count, calm.within.count);
  EXPECT_EQ(calm.as_planned->cost, 0);
  SimulateOptions options = as_planned(400);
  options.map_sigma_m = 8;
  const Simulation shifted = made.fly(options);
  EXPECT_EQ(shifted.as_planned->within.count, calm.within.count) << "the same flights";
  EXPECT_GT(shifted.as_planned->cost, 0);
  EXPECT_DOUBLE_EQ(shifted.as_planned->cost, calm.within.value() - shifted.within.value());
  EXPECT_GT(shifted.as_planned->cost, shifted.as_planned->cost_interval.low);
  EXPECT_LT(shifted.as_planned->cost, shifted.as_planned->cost_interval.high);
}

TEST(SimulateFlightsThorough, FindsTheWorstPlaceToLoseGnss) {
  const Case made = case_of(0.35);
  SimulateOptions options = as_planned(300);
  options.lost_every_km = 1.5;
  const Simulation found = made.fly(options);
  ASSERT_EQ(found.losses.size(), 3U);
  for (const SimulatedLoss& loss : found.losses) EXPECT_GE(loss.within.count, found.within.count);
  EXPECT_EQ(found.losses[0].lost_from_m, 0);
  EXPECT_EQ(found.losses[0].within.count, found.within.count) << "GNSS only ever helps";
  EXPECT_GT(found.losses[2].within.count, found.losses[0].within.count);
  options.lost_every_km.reset();
  options.lost_from_km = 3;
  const Simulation alone = made.fly(options);
  EXPECT_EQ(found.losses[2].within.count, alone.within.count) << "the same flights, lost at the same place";
  EXPECT_EQ(found.losses[2].planned_p, alone.planned_p);
  options.lost_every_km = 1;
  EXPECT_THROW(made.fly(options), UsageError);
  options.lost_from_km.reset();
  options.lost_every_km = 0.01;
  EXPECT_THROW(made.fly(options), UsageError) << "400 places";
}

TEST(SimulateFlights, EllipsesHold95Of100TruePlaces) {
  const Case made = case_of(0.5);
  SimulateOptions options;
  options.flights = 50;
  EXPECT_TRUE(std::isnan(made.fly(options).marks.back().true_place.major_m)) << "too few flights";
  options.flights = 60;
  const Simulation found = made.fly(options);
  ASSERT_EQ(found.tracks.size(), kMostTracks);
  const std::vector<FlightSample>& samples = made.mission.flight.samples;
  int inside = 0;
  for (const SimulatedTrack& track : found.tracks) {
    ASSERT_EQ(track.places.true_off_line_m.size(), samples.size());
    const TruePlaceEllipse& ellipse = found.marks.back().true_place;
    EXPECT_GE(ellipse.major_m, ellipse.minor_m);
    const std::vector<Eigen::Vector2d> axes_m = ellipse_outline_m(ellipse, 4);
    const Eigen::Vector2d off_m = track.places.true_off_line_m.back();
    const double along = off_m.dot(axes_m[0]) / axes_m[0].squaredNorm();
    const double across = off_m.dot(axes_m[1]) / axes_m[1].squaredNorm();
    inside += along * along + across * across <= 1 ? 1 : 0;
  }
  EXPECT_GE(inside, 47 - 3) << "three of all 60 lie outside";
  EXPECT_LE(inside, 50);
}

TEST(SimulateFlights, DrawsWhereItFlew) {
  const Case made = case_of(0.5);
  SimulateOptions options;
  options.flights = 60;
  const Simulation found = made.fly(options);
  const std::vector<VectorLayer> layers = simulation_layers(made.mission, found);
  ASSERT_EQ(layers.size(), 2U);
  EXPECT_EQ(layers[0].name, "true_places");
  EXPECT_EQ(layers[0].features.size(), found.marks.size());
  EXPECT_EQ(layers[1].features.size(), 2 * kMostTracks);
  // Of the first flight, where it truly was at the end: as far from the line as the simulation says.
  const VectorFeature& first = layers[1].features[kMostTracks];
  EXPECT_EQ(std::get<std::string>(first.values[1]), "true");
  const GeodeticPoint end{first.points.back().x(), first.points.back().y()};
  EXPECT_NEAR(geodesic_between(made.mission.flight.samples.back().point, end).length_m,
              found.tracks[0].places.true_off_line_m.back().norm(), 0.01);
  EXPECT_THROW(check_track_file("tracks.shp"), UsageError);
}

}  // namespace
}  // namespace pilotage
