#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/base/statistics.h"

namespace pilotage {

/// Hits below their filter's own threshold, down to this score, still count for precision over recall.
inline constexpr double kLeastScore = -1.0;

/// A hit that was compared with what is there.
struct JudgedHit {
  double score = 0;
  bool right = false;     ///< The first, by score, of a landmark that is to be found.
  std::size_t block = 0;  ///< Of ground, or any other part whose own hits choose no threshold for it.
};

/// Area under the precision over the recall of hits by falling score, each precision the largest at that recall or a
/// higher one (M. Everingham et al., "The PASCAL Visual Object Classes challenge: a retrospective", 2015, all points).
/// NaN when nothing is to be found.
double average_precision(std::vector<JudgedHit> hits, std::int64_t to_find);

/// The score from which on precision and recall have the largest harmonic mean; of equals the highest. Infinite without
/// a right hit.
double best_threshold(std::vector<JudgedHit> hits, std::int64_t to_find);

}  // namespace pilotage
