#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pilotage/flightlog/match_evaluation.h"
#include "pilotage/matchability/prediction_quality.h"
#include "pilotage/mission/integrity.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/mission/simulation.h"
#include "pilotage/replay/flown_line.h"
#include "pilotage/replay/grade_fit.h"
#include "pilotage/replay/predicted_tiles.h"
#include "pilotage/replay/replayed_frame.h"
#include "pilotage/replay/tile_contradictions.h"

namespace pilotage {

/// P of the tiles below against what came of the tries over them.
struct PredictedAgainstFlown {
  std::int64_t too_unsure =
      0;                   ///< Tries over a tile with a P that count nowhere here: ReplayScoring::max_prior_sigma_m.
  std::int64_t tries = 0;  ///< Over a stored tile with a P.
  Share observed;          ///< Right (or unjudged) fixes, of the tries.
  double predicted = std::numeric_limits<double>::quiet_NaN();  ///< Mean P of the tries.
  PredictionQuality quality;  ///< Deciles, Brier skill, AUC; intervals by blocks along the track.
  /// Σ (y − p) in standard deviations, were the tries independent; and with the level of the place, which they share.
  double large_z = std::numeric_limits<double>::quiet_NaN();
  double large_z_with_level = std::numeric_limits<double>::quiet_NaN();
};

struct FlownLeg {
  int leg = 0;
  double planned_p = std::numeric_limits<double>::quiet_NaN();  ///< LegStatus::p_within_limit.
  double planned_p_fix = std::numeric_limits<double>::quiet_NaN();
  double planned_max_error_m = std::numeric_limits<double>::quiet_NaN();  ///< k·σ.
  TryCounts fixes;
  double predicted = std::numeric_limits<double>::quiet_NaN();  ///< Mean P of the tries over stored tiles,
  Share observed;                                               ///< and how many of them gave a fix.
  std::int64_t errors = 0;                                      ///< Fixes whose truth is known.
  double median_error_m = std::numeric_limits<double>::quiet_NaN();
  double largest_error_m = std::numeric_limits<double>::quiet_NaN();
};

/// A quantity of the flown line beside the planned one.
struct FlownQuantity {
  std::int64_t count = 0;
  double median = std::numeric_limits<double>::quiet_NaN();   ///< Of the values,
  double p95_abs = std::numeric_limits<double>::quiet_NaN();  ///< and of their amounts.
  double largest_abs = std::numeric_limits<double>::quiet_NaN();
};

struct FlownLine {
  std::int64_t frames = 0;  ///< With a place on the line.
  std::int64_t away = 0;    ///< Farther from it than anything planned.
  FlownQuantity offset_m, height_error_m, heading_error_deg, speed_ratio;
  std::int64_t beyond_corridor = 0;
  std::int64_t beyond_heights = 0;
};

/// A pass over a stored tile: one line for `calibrate`.
struct TilePass {
  PredictedTile tile;
  std::int64_t block = 0;
  std::string file;  ///< The frame nearest to the tile's centre,
  std::string status;
  Outcome outcome = Outcome::kRefused;  ///< and what came of it.
  double error_m = std::numeric_limits<double>::quiet_NaN();
  bool won = false;  ///< Any frame of the pass gave a fix.
};

struct Replay {
  std::optional<double> max_prior_sigma_m;
  std::vector<std::string> flights;  ///< Their names.
  double correct_within_m = 0;
  bool has_truth = false;
  std::string priors;
  TryCounts fixes;
  double median_error_m = std::numeric_limits<double>::quiet_NaN();
  double p95_error_m = std::numeric_limits<double>::quiet_NaN();
  NeesSummary nees;                                 ///< Of right fixes.
  std::optional<PredictedAgainstFlown> prediction;  ///< Nothing where no try by one map was over such a tile.
  std::vector<FlownLeg> legs;                       ///< Of the plan; empty without one.
  std::optional<FlownLine> line;
  std::optional<double> planned_p;
  std::optional<Integrity> integrity;  ///< Frames whose truth is known, by the plan's limit; nothing without a plan.
  std::optional<GradeFit> grade;
  std::string grade_name;
  Contradictions contradictions;
  std::vector<TilePass> passes;
  std::vector<std::string> notes;
};

/// The plan that was flown.
struct FlownPlan {
  const Mission& mission;
  const Selection& selection;
};

struct ReplayScoring {
  double correct_within_m = 5;
  double block_m = 500;  ///< Tries of one block of the way are not independent of each other.
  /// P is that of priors within the mission's limit; a try with a less sure one says nothing of it.
  std::optional<double> max_prior_sigma_m;
  std::uint64_t seed = 1;
  int threads = 0;
};

/// Holds flights against what was predicted of them. `model` is the inertial system that the priors are of; without it
/// no grade is fitted. docs/methods/replay.md.
Replay score_replay(std::span<const ReplayedFlight> flights, PredictedTiles& tiles,
                    const std::optional<FlownPlan>& plan, const std::optional<InsErrorModel>& model,
                    const ReplayScoring& scoring);

}  // namespace pilotage
