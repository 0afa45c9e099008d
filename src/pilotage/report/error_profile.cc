#include "pilotage/report/error_profile.h"

#include <algorithm>
#include <cmath>

namespace pilotage {
namespace {

// Orders by error, NaN last.
bool smaller_error(const ErrorSample& a, const ErrorSample& b) {
  if (std::isnan(a.error_m) || std::isnan(b.error_m)) return !std::isnan(a.error_m) && std::isnan(b.error_m);
  return a.error_m < b.error_m;
}

}  // namespace

std::vector<FixStretch> fix_stretches(const std::vector<ErrorSample>& profile) {
  std::vector<FixStretch> stretches;
  bool open = false;
  for (const ErrorSample& sample : profile) {
    if (sample.matchable && !open) stretches.push_back({sample.distance_m, sample.distance_m});
    if (sample.matchable || open) stretches.back().to_distance_m = sample.distance_m;
    open = sample.matchable;
  }
  return stretches;
}

std::vector<ErrorSample> thin_profile(const std::vector<ErrorSample>& profile, std::size_t max_samples) {
  if (profile.size() <= max_samples) return profile;
  const std::size_t stretches = max_samples / 4;
  std::vector<ErrorSample> thinned;
  for (std::size_t i = 0; i < stretches; ++i) {
    const std::size_t first = profile.size() * i / stretches;
    const std::size_t last = profile.size() * (i + 1) / stretches;  // > first: there are more samples than stretches
    const auto begin = profile.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = profile.begin() + static_cast<std::ptrdiff_t>(last);
    const auto [least, most] = std::minmax_element(begin, end, smaller_error);
    std::vector<std::ptrdiff_t> kept = {0, least - begin, most - begin, end - begin - 1};
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    for (const std::ptrdiff_t offset : kept) thinned.push_back(begin[offset]);
  }
  return thinned;
}

}  // namespace pilotage
