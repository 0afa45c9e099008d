#include "pilotage/matchability/reasons.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

// Thresholds: docs/methods/reasons.md says where each comes from.
constexpr double kEnoughGround = 0.75;
constexpr double kEnoughContrast = 0.15;  // σ/f̄ = √deficit
constexpr double kEnoughFeatures = 60;
constexpr double kMostVoteNoise = 0.03;   // per feature
constexpr double kMostRivalRatio = 0.75;  // R₂/R₁ of the clean surface
constexpr double kMuchVegetation = 0.8;
constexpr double kMuchWater = 0.1;
constexpr double kLeastAperture = 0.2;
constexpr double kMuchRelief = 0.15;  // of the height above ground
constexpr double kEnoughPixels = 100;
constexpr double kEpochMargin = 0.05;
constexpr double kEpochSurvival = 0.1;
constexpr double kSoft = 0.8;
constexpr double kSuspicion = 0.99;
constexpr double kHeaviest = 10;
constexpr std::size_t kMostReasons = 3;

std::string percent(double share) {
  return format_fixed(100 * share, 0) + " %";
}

/// How far `value` is below `enough`; 1 = at it. NaN has no weight.
double short_of(double value, double enough) {
  if (std::isnan(value)) return 0;
  return value <= enough / kHeaviest ? kHeaviest : enough / value;
}

double beyond(double value, double most) {
  return std::isnan(value) ? 0 : std::min(value / most, kHeaviest);
}

/// "84 m to the north-east"; by pixels where the grid counts degrees.
std::string direction(double dx_px, double dy_px, const ReasonContext& context) {
  const GeoTransform& place = context.matrix.map_from_pixel;
  const Eigen::Vector2d map = place.map_from_pixel({dx_px, dy_px}) - place.map_from_pixel({0, 0});
  const std::string distance = std::isnan(context.metres_per_unit)
                                   ? format_fixed(std::hypot(dx_px, dy_px), 0) + " px"
                                   : format_fixed(map.norm() * context.metres_per_unit, 0) + " m";
  return distance + " to the " + compass_name(std::atan2(map.x(), map.y()) / kRadPerDeg);
}

Reason too_little_ground(const TileScores& score) {
  return {ReasonCode::kTooLittleGround, "The imagery covers only " + percent(score.valid_fraction) + " of the tile.",
          score.status == TileStatus::kTooLittleGround ? kHeaviest : short_of(score.valid_fraction, kEnoughGround)};
}

Reason flat(const TileScores& score) {
  if (score.status == TileStatus::kFlat) {
    return {ReasonCode::kFlat, "All pixels have the same gray value: there is nothing to recognise.", kHeaviest};
  }
  const double contrast = std::sqrt(std::max(score.frieden_deficit, 0.0));
  return {ReasonCode::kFlat,
          "Low contrast: gray values differ by " + format_fixed(100 * contrast, 0) + " % of their mean.",
          std::isnan(score.frieden_deficit) ? 0 : short_of(contrast, kEnoughContrast)};
}

Reason few_features(const TileScores& score) {
  return {ReasonCode::kFewFeatures,
          "Only " + format_fixed(score.map_features, 0) + " features to recognise; a safe fix needs about " +
              format_fixed(kEnoughFeatures, 0) + ".",
          short_of(score.map_features, kEnoughFeatures)};
}

Reason repeats(const TileScores& score, const ReasonContext& context) {
  Reason rival{ReasonCode::kRepeats, "", beyond(score.clean.rival_ratio, kMostRivalRatio)};
  if (rival.weight > 0) {
    // A ratio cannot grow far beyond 1, so what is left of the margin counts.
    rival.weight = std::max(0.0, short_of(1 - score.clean.rival_ratio, 1 - kMostRivalRatio));
    rival.text = "Looks like the ground " + direction(score.clean.rival_dx_px, score.clean.rival_dy_px, context) +
                 " (correlation there " + percent(score.clean.rival_ratio) + " of its own).";
  }
  const double noise =
      score.map_features > 0 ? score.vote_noise / score.map_features : std::numeric_limits<double>::quiet_NaN();
  const Reason alike{ReasonCode::kRepeats,
                     "Its features look like each other: wrong places get " + format_fixed(100 * noise, 1) +
                         " votes for every hundred of them (" + format_fixed(100 * kMostVoteNoise, 0) + " is much).",
                     beyond(noise, kMostVoteNoise)};
  return rival.weight >= 1 || rival.weight >= alike.weight ? rival : alike;
}

/// Not measured, it is a suspicion: some forests are found better than anything else (docs/methods/reasons.md), so it
/// is told of a low P only, and behind what is plain.
Reason vegetation(const TileScores& score) {
  const std::string green = percent(score.vegetation_share) + " of it is green";
  const double weight = beyond(score.vegetation_share, kMuchVegetation);
  if (std::isnan(score.epoch.margin)) {
    return {ReasonCode::kVegetation, green + ": plants may look different in another season.",
            std::min(kSoft * weight, kSuspicion)};
  }
  return {ReasonCode::kVegetation,
          green + ", and the second date looks different (margin " + format_fixed(score.epoch.margin, 2) + ").",
          score.epoch.margin < kEpochMargin ? 2 * weight : 0};
}

Reason water(const TileScores& score) {
  return {ReasonCode::kWater, percent(score.water_share) + " of it looks like open water: nothing there stays.",
          beyond(score.water_share, kMuchWater)};
}

Reason edge_only(const TileScores& score) {
  return {
      ReasonCode::kEdgeOnly,
      "Its edges run in one direction (" + percent(score.aperture) + " as strong across): a fix may slide along them.",
      short_of(score.aperture, kLeastAperture)};
}

Reason relief(const TileScores& score, const ReasonContext& context) {
  const double share = score.relief_m / context.min_agl_m;
  return {ReasonCode::kRelief,
          "Its heights differ by " + format_fixed(score.relief_m, 0) + " m, " + percent(share) + " of the " +
              format_fixed(context.min_agl_m, 0) + " m above ground: the picture shifts with the point of view.",
          beyond(share, kMuchRelief)};
}

Reason coarse(const ReasonContext& context) {
  const int side = context.matrix.tile_size_px;
  const double pixel_m = std::sqrt(std::abs(context.matrix.map_from_pixel.determinant())) * context.metres_per_unit;
  const std::string pixel = std::isnan(pixel_m) ? "" : format_fixed(pixel_m, 2) + " m ";
  return {ReasonCode::kCoarse,
          "A frame shows only " + std::to_string(side) + " x " + std::to_string(side) + " pixels of " + pixel +
              "of the map; below " + format_fixed(kEnoughPixels, 0) +
              " fixes get rare: fly higher, or take finer imagery.",
          short_of(side, kEnoughPixels)};
}

Reason changed(const TileScores& score) {
  const double by_margin = std::isnan(score.epoch.margin) ? 0 : score.epoch.margin < kEpochMargin ? 1.5 : 0;
  const double by_survival = short_of(score.epoch.survival, kEpochSurvival);
  Reason reason{ReasonCode::kChanged, "", std::max(by_margin, by_survival)};
  if (by_survival >= by_margin && by_survival > 0) {
    reason.text = "Changed: only " + percent(score.epoch.survival) + " of its features are found on the second date.";
  } else if (by_margin > 0) {
    reason.text = "Changed: on the second date a wrong place correlates nearly as well (margin " +
                  format_fixed(score.epoch.margin, 2) + ").";
  }
  return reason;
}

Reason weak(const TileScores& score) {
  std::string text = "No single cause: it has too little of everything";
  if (!std::isnan(score.map_features)) {
    text += " (" + format_fixed(score.map_features, 0) + " features against a noise of " +
            format_fixed(score.vote_noise, 1) + " votes)";
  }
  return {ReasonCode::kWeak, text + ".", 1};
}

}  // namespace

ReasonContext reason_context(const Crs& crs, const GridLevel& level) {
  return {level.matrix, crs.metres_per_unit(), level.min_agl_m};
}

std::vector<Reason> tile_reasons(const TileScores& score, const ReasonContext& context) {
  if (score.status == TileStatus::kTooLittleGround) return {too_little_ground(score)};
  if (score.status == TileStatus::kFlat) return {flat(score)};
  const bool low = score.p_correct_fix < context.low_p;
  if (score.p_correct_fix >= context.watch_p) return {};
  std::vector<Reason> reasons{too_little_ground(score), flat(score),   few_features(score), repeats(score, context),
                              vegetation(score),        water(score),  edge_only(score),    relief(score, context),
                              coarse(context),          changed(score)};
  const double least = low ? kSoft : 1;
  std::erase_if(reasons, [&](const Reason& reason) { return !(reason.weight >= least); });
  std::stable_sort(reasons.begin(), reasons.end(),
                   [](const Reason& a, const Reason& b) { return a.weight > b.weight; });
  if (reasons.size() > kMostReasons) reasons.resize(kMostReasons);
  if (low && reasons.empty()) reasons.push_back(weak(score));
  return reasons;
}

std::string reasons_text(const std::vector<Reason>& reasons) {
  std::vector<std::string> texts;
  for (const Reason& reason : reasons) texts.push_back(reason.text);
  return join(texts, " ");
}

std::vector<ReasonCode> reason_codes(const TileScores& score, const ReasonContext& context) {
  std::vector<ReasonCode> codes;
  for (const Reason& reason : tile_reasons(score, context)) codes.push_back(reason.code);
  return codes;
}

}  // namespace pilotage
