#include "pilotage/registration/surviving_features.h"

#include "pilotage/vision/hamming.h"

namespace pilotage {

std::vector<std::uint8_t> surviving_features(const FeatureSet& reference, const FeatureSet& registered_second) {
  std::vector<std::uint8_t> survives(reference.size(), 0);
  if (reference.size() == 0 || registered_second.size() == 0) return survives;
  std::vector<HammingWindow> windows;
  windows.reserve(reference.size());
  for (const Feature& feature : reference.features) {
    const auto x_px = static_cast<double>(feature.x_px);
    const auto y_px = static_cast<double>(feature.y_px);
    windows.push_back(
        {x_px - kSurvivalRadiusPx, y_px - kSurvivalRadiusPx, x_px + kSurvivalRadiusPx, y_px + kSurvivalRadiusPx});
  }
  const auto most_bits = static_cast<std::uint32_t>(descriptor_of(reference).survival_bits());
  const HammingMatches matches =
      HammingIndex(registered_second).find_nearest(reference, windows, 1, best_hamming_path(), most_bits);
  for (std::size_t i = 0; i < survives.size(); ++i) survives[i] = matches.of_query(i)[0].found() ? 1 : 0;
  return survives;
}

}  // namespace pilotage
