#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/mission/simulation.h"
#include "pilotage/reroute/no_fly_zones.h"
#include "pilotage/reroute/reroute.h"

namespace pilotage {

/// A line with what the selection predicts of it, and the verdict on that.
struct JudgedLine {
  Mission mission;
  std::vector<TileScores> scores;
  Selection selection;
  QualityStatus status = QualityStatus::kBad;
  std::string text;      ///< The verdict in one line, as `prepare` prints it.
  std::string headline;  ///< Its parts (verdict/verdict.h).
  std::string detail;
  std::string second_date;  ///< What was taken for granted of it (score/score_second_epoch.h); "" without one.
};

/// Fills status, text and its parts from the rest, and from drawn flights where there are any, by the rows and the
/// words of every verdict (verdict/quality.h, verdict/verdict.h).
void judge(JudgedLine& line, const std::optional<Simulation>& simulation = std::nullopt);

/// Is a a better line than b, whatever they cost? By verdict, then P, then largest error.
bool is_safer(const JudgedLine& a, const JudgedLine& b);

/// Its figures for the result.
RerouteLine figures_of(const JudgedLine& line, const NoFlyZones& zones);

/// Plans, scores, selects and flies a mission as `prepare` does, and judges it. Throws as the stages.
JudgedLine judge_as_prepare(const PrepareOptions& options, const TileOptions& tile, const RerouteRun& run,
                            const Progress& progress);

}  // namespace pilotage
