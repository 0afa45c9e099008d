#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/selection.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/route_probability.h"
#include "pilotage/simulate/simulate_options.h"

namespace pilotage {

/// A mission with its map, and what is worked out once for all flights. The mission must outlive it.
struct SimulatedMission {
  /// P of a right fix of a stored tile, as the logit that the level of the place is added to.
  struct TileChance {
    bool stored = false;
    double logit = 0;        ///< −∞ and ∞ for a P of 0 and 1.
    double level_sigma = 0;  ///< Of the place's level.
    double mean_p = 0;       ///< P over all levels, as the table has it.
  };

  FlightPath path;              ///< With the conditions that are flown.
  FlightConditions conditions;  ///< The plan's, with what SimulateOptions changes.
  std::vector<TileChance> tiles;
  std::vector<FixAttempt> attempts;          ///< Where tries are made, as the plan makes them.
  std::vector<Eigen::Matrix2d> map_from_en;  ///< At each sample: the axes of the grid.
  std::vector<double> marks_m;               ///< Where errors are looked at: at equal distances, and at the end.
  FixTries tries;
  double lost_from_m = 0;             ///< Where GNSS is lost first.
  double planned_p = 0;               ///< Of the whole route, by the plan's own recursion in the plan's conditions.
  std::vector<double> planned_leg_p;  ///< Of each leg, as LegStatus::p_within_limit.
};

/// Throws UsageError when `lost_from_km` is beyond the route's end (of `lost_every_km` it knows nothing), DataError
/// when the selection has no figures of its tries, or its tiles are not of the mission.
SimulatedMission make_simulated_mission(const Mission& mission, const std::vector<TileScores>& scores,
                                        const Selection& selection, const SimulateOptions& options, int threads);

/// P of a right fix over a tile where the place's level is `level_z` standard deviations from its mean.
double p_at_level(const SimulatedMission::TileChance& tile, double level_z);

}  // namespace pilotage
