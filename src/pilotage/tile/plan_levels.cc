#include "pilotage/tile/plan_levels.h"

#include <algorithm>
#include <cmath>

namespace pilotage {

std::vector<AglBand> agl_bands(const std::vector<double>& agl_m) {
  const auto [lowest, highest] = std::minmax_element(agl_m.begin(), agl_m.end());
  const double octaves = std::log2(*highest / *lowest);
  const int count = std::max(1, static_cast<int>(std::ceil(octaves - 1e-9)));
  std::vector<AglBand> bands;
  for (int i = 0; i < count; ++i) {
    const double low = *lowest * std::exp2(octaves * i / count);
    const double high = i + 1 == count ? *highest : *lowest * std::exp2(octaves * (i + 1) / count);
    bands.push_back({low, high, std::sqrt(low * high)});
  }
  // A route that climbs steeply has no sample between its heights.
  std::vector<bool> flown(bands.size());
  for (const double height_m : agl_m) flown[static_cast<std::size_t>(band_of(bands, height_m))] = true;
  std::vector<AglBand> served;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    if (flown[i]) served.push_back(bands[i]);
  }
  return served;
}

int band_of(const std::vector<AglBand>& bands, double agl_m) {
  for (std::size_t i = 0; i < bands.size(); ++i) {
    if (agl_m <= bands[i].max_agl_m) return static_cast<int>(i);
  }
  return static_cast<int>(bands.size()) - 1;
}

}  // namespace pilotage
