#include "pilotage/ground/tile_scores.h"

#include <cmath>

namespace pilotage {

double judged_margin(const TileScores& score) {
  return std::isnan(score.degraded.margin) ? score.clean.margin : score.degraded.margin;
}

}  // namespace pilotage
