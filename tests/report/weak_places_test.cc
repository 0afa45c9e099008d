#include "pilotage/report/weak_places.h"

#include <algorithm>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/report/report.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::report_with_gap;

TEST(WeakPlaces, AGapOverTheLimitSaysWhereWhyAndWhatToDo) {
  const Report report = report_with_gap(0.03);
  ASSERT_EQ(report.weak_places.size(), 1U) << "legs that the gap explains are not told again";
  const WeakPlace& place = report.weak_places[0];
  EXPECT_EQ(place.status, QualityStatus::kBad);
  EXPECT_EQ(place.from_distance_m, report.gaps[0].gap.from_distance_m);
  EXPECT_EQ(place.to_distance_m, report.gaps[0].gap.to_distance_m);
  EXPECT_EQ(place.where, "1.1 km – 3.2 km, legs 2 to 4");
  EXPECT_THAT(place.what, HasSubstr("without a fix; error at its end 68 m > 50 m"));
  int tiles = 0;
  int green = 0;
  for (const ReportTile& tile : report.tiles) {
    const double along_m = tile.place.distance_m;
    if (tile.selected || along_m < place.from_distance_m || along_m > place.to_distance_m) continue;
    ++tiles;
    const auto& reasons = tile.score.reasons;
    if (std::find(reasons.begin(), reasons.end(), ReasonCode::kVegetation) != reasons.end()) ++green;
  }
  EXPECT_THAT(place.why, HasSubstr("Vegetation (" + std::to_string(green) + " of " + std::to_string(tiles) +
                                   " tiles), hardly any"))
      << "causes before what follows from them";
  EXPECT_EQ(place.todo, "Lead the route along roads or buildings, or use imagery of the same season.");
}

TEST(WeakPlaces, WorstFirstAndNoMoreThanAsked) {
  Report report = report_with_gap(0.018);
  report.gaps.push_back(report.gaps[0]);
  report.gaps.push_back(report.gaps[0]);
  report.gaps[1].gap.error_m = 70;
  report.gaps[1].gap.within_limit = false;
  report.gaps[1].quality = QualityStatus::kBad;
  report.gaps[2].gap.p_first_excess = 0.1;
  const std::vector<WeakPlace> places = weak_places(report, {}, 2);
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0].status, QualityStatus::kBad);
  EXPECT_THAT(places[0].what, HasSubstr("70 m > 50 m"));
  EXPECT_THAT(places[1].what, HasSubstr("≤ 50 m"));
  EXPECT_EQ(weak_places(report, {}, 9).size(), 3U);
}

TEST(WeakPlaces, ALegOverItsShareWithoutAGapIsAPlaceToo) {
  Report report = report_with_gap(0.01);
  report.gaps.clear();
  report.legs[2].quality = QualityStatus::kMarginal;
  report.legs[2].status.max_error_m = 45;
  const std::vector<WeakPlace> places = weak_places(report, {});
  ASSERT_EQ(places.size(), 1U);
  EXPECT_THAT(places[0].where, HasSubstr("leg 3"));
  EXPECT_EQ(places[0].what, "Largest error 45 m ≤ 50 m.");
}

TEST(WeakPlaces, TooSmallAProbabilityNamesTheStretchWhereFlightsAreLost) {
  Report report = report_with_gap(0.01);
  report.gaps.clear();
  report.probability = RouteProbability{0.7, 0.9, 10, 0.01, WorstStretch{1, 900, 1500, 0.25}, {}};
  ASSERT_EQ(weak_places(report, {}).size(), 1U);
  EXPECT_THAT(weak_places(report, {})[0].what, HasSubstr("with P = 0.250 the error first exceeds its limit"));
  EXPECT_EQ(weak_places(report, {})[0].status, QualityStatus::kBad);
  report.probability->p_within_limit = 0.95;
  EXPECT_THAT(weak_places(report, {}), IsEmpty());
}

TEST(WeakPlaces, TheSelectionsAdviceComesBeforeGeneralWords) {
  const Report report = report_with_gap(0.03);
  const std::vector<LegAdvice> advice = {{0, AdviceSide::kLeft, 10, 0.1, 0.9, true},  // a leg before the gap
                                         {2, AdviceSide::kRight, 40, 0.5, 0.91, true},
                                         {3, AdviceSide::kNone, 0, 0.6, 0.6, false}};  // no better
  EXPECT_EQ(weak_places(report, advice)[0].todo,
            "Leg 3 flown 40 m to the right stays within the limit with P = 0.910 instead of 0.500.");
}

TEST(WeakPlaces, WhereChosenTilesAreTooWeakItIsNotCalledUncovered) {
  testing::ReportSceneOptions options;
  options.matchable_from = 0;
  options.matchable_to = 0.01;
  ReportInput input = testing::report_scene(options);
  input.selection.probability = RouteProbability{0, 0.9, 0.1, 0.0001, WorstStretch{0, 0, 139, 1}, {}};
  input.mission.flight.ins.grade = InsGrade::kConsumer;
  for (ErrorSample& sample : input.selection.error_profile)
    sample.p_correct_fix = sample.distance_m < 100 ? 0.46 : 0.97;
  input.selection.tile_ids.clear();
  for (const GroundTile& tile : input.mission.ground.tiles) input.selection.tile_ids.push_back(tile.tile_id);
  input.selection.legs[0].p_within_limit = 0;
  const Report report = make_report(input);
  const WeakPlace& place = report.weak_places.at(0);
  EXPECT_EQ(place.status, QualityStatus::kBad);
  EXPECT_THAT(place.why, HasSubstr("From its start the inertial system alone stays within 50 m for "));
  EXPECT_THAT(place.why, HasSubstr("A frame over the chosen tiles there gives a fix with P 0.46 to 0.97."));
  EXPECT_THAT(place.why, Not(HasSubstr("No tile")));
  EXPECT_THAT(place.todo, HasSubstr("better inertial grade"));
  for (const WeakPlace& other : report.weak_places) EXPECT_THAT(other.why, Not(HasSubstr("No tile")));
  EXPECT_EQ(report.legs[0].quality, QualityStatus::kBad);
  EXPECT_EQ(report.legs[1].quality, QualityStatus::kBad) << "not reached within the limit";
}

TEST(WeakPlaces, WithoutTilesItSaysSo) {
  Report report = report_with_gap(0.03);
  report.tiles.clear();
  EXPECT_EQ(weak_places(report, {})[0].why, "No tile of the plan lies there.");
}

}  // namespace
}  // namespace pilotage
