#include "pilotage/verdict/tile_class.h"

#include <cmath>

#include "pilotage/base/text.h"

namespace pilotage {

std::optional<TileClass> tile_class(const TileScores& score) {
  using ClassLimits = TileClassThresholds;
  if (score.status != TileStatus::kScored) return TileClass::kNoGo;
  if (!std::isnan(score.p_correct_fix)) {
    if (score.p_correct_fix >= ClassLimits::kGoodP) return TileClass::kGo;
    return score.p_correct_fix >= ClassLimits::kMatchableP ? TileClass::kMarginal : TileClass::kNoGo;
  }
  if (std::isnan(score.degraded.margin)) return std::nullopt;
  if (score.degraded.margin >= ClassLimits::kGoodMargin) return TileClass::kGo;
  return score.degraded.margin > ClassLimits::kMatchableMargin ? TileClass::kMarginal : TileClass::kNoGo;
}

std::string tile_classes_meaning() {
  using ClassLimits = TileClassThresholds;
  return "go: P(correct fix) from " + format_number(ClassLimits::kGoodP) + "; marginal: from " +
         format_number(ClassLimits::kMatchableP) +
         "; no-go: less, or nothing to match. Where no P is known: a margin of " +
         format_number(ClassLimits::kGoodMargin) + " over every rival on degraded copies, any, none";
}

Rgb status_color(QualityStatus status) {
  if (status == QualityStatus::kGood) return {0x00, 0x72, 0xb2};
  return status == QualityStatus::kMarginal ? Rgb{0xe6, 0x9f, 0x00} : Rgb{0xd5, 0x00, 0x8a};
}

const std::vector<RasterClass>& tile_classes() {
  static const std::vector<RasterClass> classes = [] {
    std::vector<RasterClass> list;
    for (const auto& [name, status] :
         {std::pair("go", QualityStatus::kGood), std::pair("marginal", QualityStatus::kMarginal),
          std::pair("no-go", QualityStatus::kBad)}) {
      const Rgb color = status_color(status);
      list.push_back({name, {color.red, color.green, color.blue}});
    }
    return list;
  }();
  return classes;
}

}  // namespace pilotage
