#include "pilotage/ground/tile_chances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pilotage/base/nan.h"
#include "pilotage/ground/place_level.h"

namespace pilotage {
namespace {

bool depends_on_level(const TileScores& score) {
  return score.level_sigma > 0 && score.p_correct_fix > 0 && score.p_correct_fix < 1;
}

void forget(std::vector<double>& p, const std::vector<bool>& chosen) {
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = chosen[i] ? p[i] : 0;
}

}  // namespace

bool can_be_matched(const TileScores& score, double min_p_correct_fix, double min_peak_margin) {
  if (score.status != TileStatus::kScored) return false;
  if (!std::isnan(score.p_correct_fix)) return score.p_correct_fix >= min_p_correct_fix;
  const double margin = judged_margin(score);
  return std::isnan(margin) || margin >= min_peak_margin;
}

bool any_p_known(const std::vector<TileScores>& scores) {
  return std::any_of(scores.begin(), scores.end(), [](const TileScores& s) { return !std::isnan(s.p_correct_fix); });
}

TileChances tile_chances(const std::vector<TileScores>& scores, const std::vector<bool>& counts) {
  std::vector<double> p(scores.size(), 0.0);
  bool any = false;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!counts[i]) continue;
    p[i] = std::isnan(scores[i].p_correct_fix) ? 1.0 : scores[i].p_correct_fix;
    any = any || depends_on_level(scores[i]);
  }
  if (!any) return level_free(std::move(p));
  TileChances chances{p, {}};
  for (const LevelNode& node : level_nodes()) chances.levels.push_back({node.weight, p});
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!counts[i] || !depends_on_level(scores[i])) continue;
    const double logit = logit_of_p(p[i], scores[i].level_sigma);
    for (std::size_t k = 0; k < chances.levels.size(); ++k) {
      chances.levels[k].p[i] = logistic(logit + scores[i].level_sigma * level_nodes()[k].z);
    }
  }
  return chances;
}

std::size_t tiles_without_p(const std::vector<TileScores>& scores, const std::vector<bool>& counts) {
  std::size_t without = 0;
  for (std::size_t i = 0; i < scores.size(); ++i) without += counts[i] && std::isnan(scores[i].p_correct_fix) ? 1 : 0;
  return without;
}

double fewest_level_tiles(const std::vector<TileScores>& scores, const std::vector<bool>& counts) {
  double fewest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (!counts[i] || std::isnan(scores[i].p_correct_fix)) continue;
    if (std::isnan(scores[i].level_tiles)) return kNaN;
    fewest = std::min(fewest, scores[i].level_tiles);
  }
  return std::isinf(fewest) ? kNaN : fewest;
}

TileChances level_free(std::vector<double> p_of_tile) {
  TileChances chances{p_of_tile, {}};
  chances.levels.push_back({1, std::move(p_of_tile)});
  return chances;
}

TileChances of_chosen(TileChances chances, const std::vector<bool>& chosen) {
  forget(chances.p, chosen);
  for (TileChances::AtLevel& level : chances.levels) forget(level.p, chosen);
  return chances;
}

}  // namespace pilotage
