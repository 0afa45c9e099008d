#include "pilotage/reroute/straighten_line.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "pilotage/base/parallel.h"

namespace pilotage {
namespace {

// Drops points that lie on the straight line between their neighbours.
void merge_collinear(std::vector<Eigen::Vector2d>& points) {
  std::vector<Eigen::Vector2d> kept;
  for (const Eigen::Vector2d& point : points) {
    while (kept.size() > 1) {
      const Eigen::Vector2d before = (kept.back() - kept[kept.size() - 2]).normalized();
      const Eigen::Vector2d after = (point - kept.back()).normalized();
      if ((before - after).norm() > 1e-9) break;
      kept.pop_back();
    }
    kept.push_back(point);
  }
  points = std::move(kept);
}

}  // namespace

LineWorth line_worth(const SearchGround& ground, const FixAgeModel& model, const std::vector<KeptWay>& kept,
                     const LinePoints& points, const LineDemand& demand) {
  LineWorth worth;
  FixAges ages = ages_at_start(model);
  std::optional<double> heading;
  worth.good = true;
  const auto fly = [&](const std::vector<FlownStep>& steps, double length_m, double first_rad, double last_rad) {
    if (!(length_m > 0)) return;
    worth.cost_m += length_m + (heading ? turn_cost_m(*heading, first_rad, demand.turn_cost_m) : 0);
    heading = last_rad;
    for (const FlownStep& step : steps) {
      fly_step(model, step, ages);
      worth.good = worth.good && !(demand.good_reach && ages.since_matchable_m > model.good_reach_m);
    }
  };
  for (std::size_t i = 0; i < kept.size(); ++i) {
    fly(kept[i].steps, kept[i].length_m, kept[i].first_heading_rad, kept[i].last_heading_rad);
    if (kept[i].length_m > 0) worth.cost_m += kept[i].turn_rad / (std::numbers::pi / 2) * demand.turn_cost_m;
    if (i == points.size()) break;
    for (std::size_t k = 1; k < points[i].size(); ++k) {
      const Eigen::Vector2d& a_m = points[i][k - 1];
      const Eigen::Vector2d& b_m = points[i][k];
      const double rad = heading_rad(a_m, b_m);
      fly(ground.steps_between(a_m, b_m), (b_m - a_m).norm(), rad, rad);
    }
  }
  worth.share_within = share_within(model, ages);
  worth.good = worth.good && worth.share_within >= demand.min_share_within;
  return worth;
}

LinePoints straighten_line(const SearchGround& ground, const FixAgeModel& model, const std::vector<KeptWay>& kept,
                           LinePoints points, const LineDemand& demand, int threads) {
  for (auto& stretch : points) merge_collinear(stretch);
  double cost_m = line_worth(ground, model, kept, points, demand).cost_m;
  while (true) {
    std::vector<std::pair<std::size_t, std::size_t>> inner;
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t k = 1; k + 1 < points[i].size(); ++k) inner.emplace_back(i, k);
    }
    std::vector<double> costs_m(inner.size(), std::numeric_limits<double>::infinity());
    const auto without = [&](std::size_t which) {
      LinePoints less = points;
      const auto [stretch, point] = inner[which];
      less[stretch].erase(less[stretch].begin() + static_cast<std::ptrdiff_t>(point));
      return less;
    };
    parallel_for(inner.size(), threads, [&](std::size_t which, int) {
      const auto [stretch, point] = inner[which];
      if (!ground.clear(points[stretch][point - 1], points[stretch][point + 1])) return;
      const LineWorth worth = line_worth(ground, model, kept, without(which), demand);
      if (worth.good) costs_m[which] = worth.cost_m;
    });
    const auto best = std::min_element(costs_m.begin(), costs_m.end());
    if (best == costs_m.end() || !(*best <= cost_m + 1e-6)) return points;
    cost_m = *best;
    points = without(static_cast<std::size_t>(best - costs_m.begin()));
  }
}

}  // namespace pilotage
