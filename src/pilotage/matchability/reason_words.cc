#include "pilotage/matchability/reason_words.h"

#include <algorithm>
#include <array>
#include <map>

namespace pilotage {
namespace {

constexpr std::array<ReasonWords, 11> kReasonWords = {{
    {ReasonCode::kTooLittleGround, "no imagery", "Add imagery there."},
    {ReasonCode::kFlat, "hardly any contrast",
     "Lead the route over ground with structure: roads, buildings, edges of fields."},
    {ReasonCode::kFewFeatures, "too few features",
     "Lead the route over ground with structure: roads, buildings, edges of fields."},
    {ReasonCode::kRepeats, "ground that repeats itself",
     "Pass beside the pattern, or fly higher so that a frame shows more than it."},
    {ReasonCode::kVegetation, "vegetation",
     "Lead the route along roads or buildings, or use imagery of the same season."},
    {ReasonCode::kWater, "open water", "Lead the route over land, along the shore."},
    {ReasonCode::kEdgeOnly, "a single straight edge", "Cross the road or shore instead of following it."},
    {ReasonCode::kRelief, "steep ground", "Fly higher above it."},
    {ReasonCode::kCoarse, "too few map pixels in a frame", "Use finer imagery, or fly higher."},
    {ReasonCode::kChanged, "ground that has changed between the dates", "Use newer imagery there."},
    {ReasonCode::kWeak, "too little of everything",
     "Lead the route over ground with structure: roads, buildings, edges of fields."},
}};

// What follows from other reasons is told after them.
bool is_symptom(ReasonCode code) {
  return code == ReasonCode::kFlat || code == ReasonCode::kFewFeatures || code == ReasonCode::kWeak;
}

}  // namespace

const ReasonWords& reason_words(ReasonCode code) {
  return *std::find_if(kReasonWords.begin(), kReasonWords.end(),
                       [&](const ReasonWords& words) { return words.code == code; });
}

ReasonCounts count_reasons(const std::vector<const TileScores*>& tiles) {
  std::map<ReasonCode, std::int64_t> counts;
  for (const TileScores* tile : tiles) {
    if (tile->status == TileStatus::kTooLittleGround) {
      ++counts[ReasonCode::kTooLittleGround];
    } else if (tile->status == TileStatus::kFlat) {
      ++counts[ReasonCode::kFlat];
    } else {
      for (const ReasonCode code : tile->reasons) ++counts[code];
    }
  }
  ReasonCounts order(counts.begin(), counts.end());
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return std::pair(is_symptom(a.first), -a.second) < std::pair(is_symptom(b.first), -b.second);
  });
  return order;
}

}  // namespace pilotage
