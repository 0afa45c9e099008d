#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/progress.h"
#include "pilotage/reroute/fix_age.h"

namespace pilotage {

/// A way from one place of the graph straight to another.
struct LineMove {
  std::uint32_t to = 0;
  float length_m = 0;
  float heading_rad = 0;  ///< Clockwise from the grid's north.
  std::uint32_t first_step = 0;
  std::uint32_t step_count = 0;
};

/// Places on the ground and the moves between them.
struct LineGraph {
  std::vector<Eigen::Vector2d> places_m;  ///< On the mission grid.
  std::vector<std::uint32_t> first_move;  ///< Of each place, and one behind the last.
  std::vector<LineMove> moves;            ///< Of each place in turn.
  std::vector<FlownStep> steps;           ///< Of each move in turn.
};

/// A way that is flown as it is: legs that are kept. Empty between two stretches that meet at a waypoint.
struct KeptWay {
  std::vector<FlownStep> steps;
  double length_m = 0;
  double turn_rad = 0;           ///< On the way itself.
  double first_heading_rad = 0;  ///< Of its first and last leg; without a meaning when it has no length.
  double last_heading_rad = 0;
};

/// A stretch of the line that is searched for.
struct SearchStretch {
  std::uint32_t from = 0;  ///< Indices of places.
  std::uint32_t to = 0;
};

/// What a line has to satisfy, and what it costs.
struct LineDemand {
  double min_share_within = 0;  ///< Of the flights, at the end.
  bool good_reach = true;       ///< No way without matchable ground is longer than FixAgeModel::good_reach_m.
  double turn_cost_m = 0;       ///< Of 90°.
};

/// How many labels the search keeps. The default finds the cheapest line of all but for what `tolerance` and
/// `most_labels` say; with 0 and kNoLimit it is exact.
struct LabelLimits {
  static constexpr std::size_t kNoLimit = static_cast<std::size_t>(-1);
  double tolerance = 0.002;             ///< A label no better than another by more than this share of flights goes.
  std::size_t most_labels = 24;         ///< At one place.
  std::size_t most_in_all = 3'000'000;  ///< Then the search gives up.
};

/// The cheapest line found.
struct FoundLine {
  std::vector<std::vector<std::uint32_t>> places;  ///< Of each stretch, from `from` to `to`.
  double cost_m = 0;                               ///< Length and turns.
  double share_within = 0;
  std::size_t labels = 0;  ///< That were looked at.
};

/// What turning by `from_rad` to `to_rad`, the shorter way round, costs.
double turn_cost_m(double from_rad, double to_rad, double cost_of_90_deg_m);

/// The cheapest line that satisfies `demand`: first the kept way 0, then stretch 0, kept way 1, stretch 1, … and the
/// last kept way; kept.size() = stretches.size() + 1. Nothing when there is none.
///
/// A label-setting shortest path with resources (as M. Desrochers, F. Soumis, A generalized permanent labelling
/// algorithm for the shortest path problem with time windows, INFOR 26(3), 1988; S. Irnich, G. Desaulniers, Shortest
/// path problems with resource constraints, in: Column Generation, 2005), in the order of A*: a label is a line to a
/// place with its cost, its heading and its flights by the age of their fix. It goes when another one at the place is
/// better in all of these, the turn from the one heading to the other paid for (docs/methods/reroute.md, where the
/// proof is). The order does not depend on threads.
std::optional<FoundLine> search_line(const LineGraph& graph, const FixAgeModel& model, const std::vector<KeptWay>& kept,
                                     const std::vector<SearchStretch>& stretches, const LineDemand& demand,
                                     const LabelLimits& limits = {}, const Progress& progress = {});

}  // namespace pilotage
