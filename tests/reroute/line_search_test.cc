#include "pilotage/reroute/line_search.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

constexpr double kApart_m = 50;

// A square grid of places, moves in eight directions, and two steps to a move with chances drawn at random.
LineGraph random_grid(int side, Random& random) {
  LineGraph graph;
  const auto place_of = [side](int column, int row) { return static_cast<std::uint32_t>(row * side + column); };
  std::vector<float> p;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      graph.places_m.emplace_back(kApart_m * column, -kApart_m * row);
      p.push_back(random.uniform() < 0.45 ? 0.0F : static_cast<float>(random.uniform(0.2, 0.9)));
    }
  }
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      graph.first_move.push_back(static_cast<std::uint32_t>(graph.moves.size()));
      for (int down = -1; down <= 1; ++down) {
        for (int right = -1; right <= 1; ++right) {
          const int to_column = column + right;
          const int to_row = row + down;
          const bool is_there = to_column >= 0 && to_row >= 0 && to_column < side && to_row < side;
          if (!is_there || (down == 0 && right == 0)) continue;
          const auto length_m = static_cast<float>(kApart_m * std::hypot(down, right));
          graph.moves.push_back({place_of(to_column, to_row), length_m, static_cast<float>(std::atan2(right, -down)),
                                 static_cast<std::uint32_t>(graph.steps.size()), 2});
          graph.steps.push_back({length_m / 2, p[place_of(column, row)]});
          graph.steps.push_back({length_m / 2, p[place_of(to_column, to_row)]});
        }
      }
    }
  }
  graph.first_move.push_back(static_cast<std::uint32_t>(graph.moves.size()));
  return graph;
}

FixAgeModel short_reach() {
  FixAgeModel model;
  model.bin_m = 25;
  model.bins = 8;
  model.window_m = 50;
  model.start_age_m = 50;
  model.good_reach_m = 160;
  model.start_good_age_m = 30;
  return model;
}

// Every walk from `place` to `to`, repeated places and all, that may still become cheaper than the best so far. It
// knows nothing of labels and of dominance.
struct BruteForce {
  const LineGraph& graph;
  const FixAgeModel& model;
  const LineDemand& demand;
  std::uint32_t to;
  double best_m;
  std::size_t walks = 0;

  void walk(std::uint32_t place, const FixAges& ages, double cost_m, const LineMove* came) {
    if (place == to) {
      best_m = std::min(best_m, cost_m);
      ++walks;
      return;
    }
    for (std::uint32_t i = graph.first_move[place]; i < graph.first_move[place + 1]; ++i) {
      const LineMove& move = graph.moves[i];
      const double turn_m = came == nullptr ? 0 : turn_cost_m(came->heading_rad, move.heading_rad, demand.turn_cost_m);
      const double next_m = cost_m + move.length_m + turn_m;
      if (next_m + (graph.places_m[to] - graph.places_m[move.to]).norm() > best_m - 1e-9) continue;
      FixAges next = ages;
      bool good = true;
      for (std::uint32_t k = 0; k < move.step_count; ++k) {
        fly_step(model, graph.steps[move.first_step + k], next);
        good = good && !(demand.good_reach && next.since_matchable_m > model.good_reach_m);
      }
      if (good && share_within(model, next) >= demand.min_share_within) walk(move.to, next, next_m, &move);
    }
  }
};

TEST(LineSearch, FindsTheCheapestOfAllWalks) {
  Random random(seed_from_name("cheapest of all walks"));
  const FixAgeModel model = short_reach();
  const LabelLimits exact{0, LabelLimits::kNoLimit, 10'000'000};
  int found_some = 0;
  int longer_than_straight = 0;
  int same_with_default_limits = 0;
  double excess = 0;
  for (int i = 0; i < 60; ++i) {
    const int side = 4;
    const LineGraph graph = random_grid(side, random);
    const LineDemand demand{random.uniform(0.3, 0.8), i % 2 == 0, i % 3 == 0 ? 0.0 : 40.0};
    const SearchStretch stretch{0, static_cast<std::uint32_t>(side * side - 1)};
    const std::vector<KeptWay> kept(2);
    const auto found = search_line(graph, model, kept, {stretch}, demand, exact);
    // A walk of three times the straight way would be found; the bound keeps the walks countable.
    const double bound_m = found ? found->cost_m + 1e-3 : 3 * kApart_m * side;
    BruteForce oracle{graph, model, demand, stretch.to, bound_m};
    oracle.walk(stretch.from, ages_at_start(model), 0, nullptr);
    if (!found) {
      EXPECT_EQ(oracle.walks, 0U) << "grid " << i;
      EXPECT_FALSE(search_line(graph, model, kept, {stretch}, demand)) << "grid " << i;
      continue;
    }
    ++found_some;
    longer_than_straight += found->cost_m > kApart_m * (side - 1) * std::numbers::sqrt2 + 1;
    EXPECT_GT(oracle.walks, 0U) << "grid " << i << ": the line that was found is no walk of the graph";
    EXPECT_NEAR(oracle.best_m, found->cost_m, 1e-3) << "grid " << i;
    const auto by_default = search_line(graph, model, kept, {stretch}, demand);
    if (!by_default) continue;
    EXPECT_GE(by_default->cost_m, found->cost_m - 1e-6);
    EXPECT_GE(by_default->share_within, demand.min_share_within);
    same_with_default_limits += by_default->cost_m < found->cost_m + 1e-6;
    excess = std::max(excess, by_default->cost_m / found->cost_m - 1);
  }
  RecordProperty("grids_with_a_line", found_some);
  RecordProperty("same_with_default_limits", same_with_default_limits);
  EXPECT_GT(found_some, 20);
  EXPECT_GT(longer_than_straight, 10) << "the demand must bind, or nothing is tested";
  EXPECT_GE(same_with_default_limits, found_some - 2) << "docs/methods/reroute.md says how often the limits matter";
  EXPECT_LT(excess, 0.1);
}

TEST(LineSearch, FliesKeptWaysBetweenStretches) {
  Random random(seed_from_name("kept ways"));
  LineGraph graph = random_grid(4, random);
  for (FlownStep& step : graph.steps) step.p = 0.8F;
  KeptWay middle;
  middle.length_m = 100;
  middle.steps = {{50, 0.8F}, {50, 0.8F}};
  middle.first_heading_rad = middle.last_heading_rad = std::numbers::pi / 2;
  // Along the upper edge, the kept way back (as if the places 3 and 8 were 100 m apart), along the third row.
  const std::vector<SearchStretch> stretches = {{0, 3}, {8, 11}};
  const auto found = search_line(graph, short_reach(), {{}, middle, {}}, stretches, {0.1, true, 100});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->places, (std::vector<std::vector<std::uint32_t>>{{0, 1, 2, 3}, {8, 9, 10, 11}}));
  EXPECT_NEAR(found->cost_m, 150 + 100 + 150, 1e-3) << "all three head east: nothing is turned";

  middle.steps = {{50, 0}, {300, 0}};  // longer than any flight gets without a fix
  EXPECT_FALSE(search_line(graph, short_reach(), {{}, middle, {}}, stretches, {0.1, false, 100}));
}

TEST(LineSearch, TurnsCostWhatIsSaid) {
  EXPECT_NEAR(turn_cost_m(0, std::numbers::pi / 2, 100), 100, 1e-9);
  EXPECT_NEAR(turn_cost_m(0.1, 2 * std::numbers::pi - 0.1, 100), 0.2 / (std::numbers::pi / 2) * 100, 1e-9);
  EXPECT_NEAR(turn_cost_m(-std::numbers::pi / 2, std::numbers::pi / 2, 100), 200, 1e-9);
}

TEST(LineSearch, GivesUpRatherThanTakeAllMemory) {
  Random random(seed_from_name("gives up"));
  const LineGraph graph = random_grid(4, random);
  EXPECT_FALSE(search_line(graph, short_reach(), std::vector<KeptWay>(2), {{0, 15}}, {0, false, 0}, {0, 24, 3}));
}

}  // namespace
}  // namespace pilotage
