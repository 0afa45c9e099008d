#include "pilotage/replay/tile_contradictions.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr double kSuspicious = 0.05;

double binomial_term(std::int64_t count, std::int64_t trials, double p) {
  if (p <= 0) return count == 0 ? 1 : 0;
  if (p >= 1) return count == trials ? 1 : 0;
  const auto k = static_cast<double>(count);
  const auto n = static_cast<double>(trials);
  return std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) + k * std::log(p) +
                  (n - k) * std::log1p(-p));
}

/// The largest chance ≤ kSuspicious that a tile may show: what is expected of it when its P is true.
double attainable(const FlownTile& tile) {
  double below = 0;
  double sum = 0;
  for (std::int64_t won = 0; won <= tile.passes; ++won) {
    sum += binomial_term(won, tile.passes, tile.p);
    if (sum > kSuspicious) break;
    below = sum;
  }
  return below;
}

}  // namespace

double binomial_at_most(std::int64_t most, std::int64_t trials, double p) {
  double sum = 0;
  for (std::int64_t count = 0; count <= most; ++count) sum += binomial_term(count, trials, p);
  return std::min(sum, 1.0);
}

Contradictions find_contradictions(std::span<const FlownTile> tiles) {
  Contradictions result;
  result.tiles = std::ssize(tiles);
  std::vector<Contradiction> all;
  for (const FlownTile& tile : tiles) {
    if (tile.won < 0 || tile.won > tile.passes || !(tile.p >= 0 && tile.p <= 1)) {
      throw UsageError("tile " + std::to_string(tile.tile_id) + ": " + std::to_string(tile.won) + " of " +
                       std::to_string(tile.passes) + " passes won with P = " + std::to_string(tile.p) + " cannot be");
    }
    all.push_back({tile, binomial_at_most(tile.won, tile.passes, tile.p), false});
    result.expected_below_5_percent += attainable(tile);
  }
  std::sort(all.begin(), all.end(), [](const Contradiction& a, const Contradiction& b) {
    return a.chance != b.chance ? a.chance < b.chance : a.tile.tile_id < b.tile.tile_id;
  });
  std::size_t rejected = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double limit = kFalseDiscoveryRate * static_cast<double>(i + 1) / static_cast<double>(all.size());
    if (all[i].chance <= limit) rejected = i + 1;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].refresh = i < rejected;
    if (all[i].refresh || all[i].chance <= kSuspicious) result.suspects.push_back(all[i]);
  }
  return result;
}

}  // namespace pilotage
