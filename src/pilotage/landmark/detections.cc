#include "pilotage/landmark/detections.h"

#include <algorithm>
#include <limits>

#include "pilotage/base/nan.h"

namespace pilotage {
namespace {

/// By falling score; of equals wrong ones first, so that nothing is gained by ties.
void sort_hits(std::vector<JudgedHit>& hits) {
  std::stable_sort(hits.begin(), hits.end(), [](const JudgedHit& a, const JudgedHit& b) {
    return a.score != b.score ? a.score > b.score : !a.right && b.right;
  });
}

}  // namespace

double average_precision(std::vector<JudgedHit> hits, std::int64_t to_find) {
  if (to_find <= 0) return kNaN;
  sort_hits(hits);
  std::vector<double> precision;
  std::int64_t right = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    right += hits[i].right ? 1 : 0;
    precision.push_back(static_cast<double>(right) / static_cast<double>(i + 1));
  }
  double area = 0;
  double envelope = 0;
  for (std::size_t i = hits.size(); i-- > 0;) {
    envelope = std::max(envelope, precision[i]);
    if (hits[i].right) area += envelope;
  }
  return area / static_cast<double>(to_find);
}

double best_threshold(std::vector<JudgedHit> hits, std::int64_t to_find) {
  sort_hits(hits);
  double best = 0;
  double threshold = std::numeric_limits<double>::infinity();
  std::int64_t right = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    right += hits[i].right ? 1 : 0;
    if (i + 1 < hits.size() && hits[i + 1].score == hits[i].score) continue;
    const double f1 =
        2.0 * static_cast<double>(right) / static_cast<double>(static_cast<std::int64_t>(i) + 1 + to_find);
    if (f1 > best) {
      best = f1;
      threshold = hits[i].score;
    }
  }
  return threshold;
}

}  // namespace pilotage
