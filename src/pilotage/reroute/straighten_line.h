#pragma once

#include <vector>

#include <Eigen/Core>

#include "pilotage/reroute/line_search.h"
#include "pilotage/reroute/search_ground.h"

namespace pilotage {

/// The points of each stretch of a line, ends included.
using LinePoints = std::vector<std::vector<Eigen::Vector2d>>;

/// What a line costs and what becomes of the flights on it, by the search's model.
struct LineWorth {
  double cost_m = 0;
  double share_within = 0;
  bool good = false;  ///< Satisfies the demand.
};
LineWorth line_worth(const SearchGround& ground, const FixAgeModel& model, const std::vector<KeptWay>& kept,
                     const LinePoints& points, const LineDemand& demand);

/// Takes waypoints out of a line, the one first whose removal saves most, the earliest among equals, as long as what is
/// left may be flown, satisfies the demand and costs no more. The result is no longer bound to the grid.
LinePoints straighten_line(const SearchGround& ground, const FixAgeModel& model, const std::vector<KeptWay>& kept,
                           LinePoints points, const LineDemand& demand, int threads);

}  // namespace pilotage
