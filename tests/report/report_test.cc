#include "pilotage/report/report.h"

#include <cmath>

#include "report/report_scene.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/report/display_plane.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

ReportInput marginal_scene() {
  testing::ReportSceneOptions options;
  options.matchable_from = 0.3;
  options.matchable_to = 0.9;
  options.drift = 0.03;
  options.tiles_along = 20;
  return testing::report_scene(options);
}

template <class Change>
std::string report_error(Change change) {
  ReportInput input = marginal_scene();
  change(input);
  return testing::error_of<DataError>([&] { make_report(input); });
}

TEST(Report, JoinsTilesScoresAndSelection) {
  const ReportInput input = marginal_scene();
  const Report report = make_report(input);
  ASSERT_EQ(report.tiles.size(), input.mission.ground.tiles.size());
  std::int64_t selected = 0;
  for (std::size_t i = 0; i < report.tiles.size(); ++i) {
    const ReportTile& tile = report.tiles[i];
    EXPECT_EQ(tile.tile.tile_id, input.mission.ground.tiles[i].tile_id);
    EXPECT_EQ(tile.score.status, input.scores[i].status);
    EXPECT_EQ(tile.score.valid_fraction, input.scores[i].valid_fraction);
    EXPECT_EQ(tile.reason.empty(), tile.selected);
    selected += tile.selected ? 1 : 0;
  }
  EXPECT_EQ(selected, report.selected_tiles);
  EXPECT_EQ(selected, static_cast<std::int64_t>(input.selection.tile_ids.size()));
}

TEST(Report, SaysWhyATileIsNotSelected) {
  ReportInput input = marginal_scene();
  input.selection.tile_ids.clear();
  input.scores[1].status = TileStatus::kFlat;
  input.scores[2].status = TileStatus::kScored;
  input.scores[2].degraded.margin = -0.02;
  input.scores[3].status = TileStatus::kScored;
  input.scores[3].degraded.margin = 0.4;
  input.scores[2].p_correct_fix = input.scores[3].p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  input.scores[4].status = TileStatus::kScored;
  input.scores[4].degraded.margin = -0.02;  // does not count where P is known
  input.scores[4].p_correct_fix = 0.0312;
  const Report report = make_report(input);
  EXPECT_THAT(report.tiles[0].reason, HasSubstr("covers 30 %"));
  EXPECT_THAT(report.tiles[1].reason, HasSubstr("same gray value"));
  EXPECT_THAT(report.tiles[2].reason, HasSubstr("margin -0.020"));
  EXPECT_THAT(report.tiles[3].reason, HasSubstr("left it out"));
  EXPECT_THAT(report.tiles[4].reason, HasSubstr("its P(correct fix) is 0.031."));

  // With what select says of its own rules, one reason: the true one.
  input.selection.left_out = LeftOut{0.2, 0.5, {input.mission.ground.tiles[5].tile_id}};
  for (const std::size_t i : {5, 6}) {
    input.scores[i] = input.scores[4];
    input.scores[i].p_correct_fix = 0.4;
  }
  const Report told = make_report(input);
  EXPECT_EQ(told.tiles[3].reason,
            "It stands out too little: its margin over every rival is 0.400, at least 0.500 is stored.");
  EXPECT_EQ(told.tiles[4].reason, "It is too seldom found: its P(correct fix) is 0.031, at least 0.200 is stored.");
  EXPECT_EQ(told.tiles[5].reason, "It does not fit into the size budget: its P(correct fix) is 0.400.");
  EXPECT_EQ(told.tiles[6].reason,
            "It is not among the fewest areas that were asked for (sparse): its P(correct fix) is 0.400.");
}

TEST(Report, GapsHaveTheirPlace) {
  const ReportInput input = marginal_scene();
  const Report report = make_report(input);
  ASSERT_EQ(report.gaps.size(), 1U);
  const ReportGap& gap = report.gaps.front();
  EXPECT_NEAR(gap.speed_mps, 28, 1e-9);
  EXPECT_NEAR(gap.length_m, 0.6 * report.route_length_m, 1e-6);
  const GeodeticPoint start = report.legs.front().from;
  const GeodeticPoint end = report.legs.back().to;
  EXPECT_NEAR(gap.from.lat_deg, start.lat_deg + 0.3 * (end.lat_deg - start.lat_deg), 1e-7);
  EXPECT_NEAR(gap.to.lon_deg, start.lon_deg + 0.9 * (end.lon_deg - start.lon_deg), 1e-7);
}

TEST(Report, WorstLegComesFirst) {
  const Report report = make_report(marginal_scene());
  ASSERT_EQ(report.worst_legs.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GE(report.legs[static_cast<std::size_t>(report.worst_legs[i - 1])].status.max_error_m,
              report.legs[static_cast<std::size_t>(report.worst_legs[i])].status.max_error_m);
  }
}

TEST(Report, CellsOfNeighboursTouchAndContainTheirCentre) {
  const Report report = make_report(marginal_scene());
  ASSERT_TRUE(report.display.drawn);
  for (std::size_t i = 0; i + 1 < report.tiles.size(); ++i) {
    const auto& cell = report.display.cells_m[i];
    const Eigen::Vector2d middle = (cell[0] + cell[1] + cell[2] + cell[3]) / 4;
    const Eigen::Vector2d center = mercator_from_geodetic(report.tiles[i].tile.center);
    EXPECT_LT((middle - center).norm(), 0.05);
    const GroundTile& tile = report.tiles[i].tile;
    const GroundTile& next = report.tiles[i + 1].tile;
    if (tile.row != next.row || tile.level != next.level) continue;
    EXPECT_LT((cell[1] - report.display.cells_m[i + 1][0]).norm(), 1e-3);
    EXPECT_LT((cell[2] - report.display.cells_m[i + 1][3]).norm(), 1e-3);
  }
}

TEST(Report, AcrossTheAntimeridianTheMapStaysInOnePiece) {
  testing::ReportSceneOptions options;
  options.origin = {179.985, -17};
  options.tiles_along = 12;
  options.turn_deg = 0;
  const Report report = make_report(testing::report_scene(options));
  ASSERT_TRUE(report.display.drawn);
  EXPECT_LT(report.display.max_x_m - report.display.min_x_m, 10000);
  EXPECT_GT(report.display.max_x_m, 20037508.34);
}

TEST(Report, NearThePoleThereIsNoMapButAllNumbers) {
  testing::ReportSceneOptions options;
  options.origin = {40, 88};
  const Report report = make_report(testing::report_scene(options));
  EXPECT_FALSE(report.display.drawn);
  EXPECT_THAT(report.display.missing, HasSubstr("85"));
  EXPECT_FALSE(report.tiles.empty());
  EXPECT_EQ(report.quality.size(), 11U);
}

TEST(Report, ContradictionsAreRefused) {
  EXPECT_THAT(report_error([](ReportInput& i) { i.scores.push_back(i.scores.front()); }),
              HasSubstr("the scores are not those of the ground's tiles"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.scores.pop_back(); }),
              HasSubstr("the scores are not those of the ground's tiles"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.selection.tile_ids.push_back(-4); }), HasSubstr("tile -4"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.selection.tile_ids.push_back(i.selection.tile_ids[0]); }),
              HasSubstr("duplicate in the selection"));
  EXPECT_THAT(
      report_error([](ReportInput& i) { i.mission.ground.tiles[1].tile_id = i.mission.ground.tiles[0].tile_id; }),
      HasSubstr("duplicate in the plan"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.mission.ground.tiles[1].level = 7; }), HasSubstr("level 7"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.selection.legs[0].leg = 4; }),
              HasSubstr("names leg 4, the route has 4 legs"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.selection.gaps[0].leg = -1; }), HasSubstr("leg -1"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.mission.flight.route.legs[0].to = 55; }),
              HasSubstr("vertices 0 and 55"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.mission.flight.samples[5].distance_m = -1; }),
              HasSubstr("not in order"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.mission.flight.samples[5].distance_m = std::nan(""); }),
              HasSubstr("not in order"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.imagery.pixels.convertTo(i.imagery.pixels, CV_16U); }),
              HasSubstr("allowed are CV_8UC3"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.imagery.valid = cv::Mat(); }), HasSubstr("mask"));
  EXPECT_THAT(report_error([](ReportInput& i) { i.imagery.map_from_pixel.x_per_col = 0; }),
              HasSubstr("cannot be inverted"));
}

TEST(Report, NothingAtAllIsStillAReport) {
  ReportInput input;
  input.geodetic_from_map = [](Eigen::Vector2d) { return GeodeticPoint{}; };
  const Report report = make_report(input);
  EXPECT_EQ(report.verdict, QualityStatus::kBad);
  EXPECT_FALSE(report.display.drawn);
  EXPECT_THAT(report_html(report), HasSubstr("There is no tile and no route to draw."));
}

}  // namespace
}  // namespace pilotage
