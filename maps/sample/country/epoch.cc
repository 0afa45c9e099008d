#include "country/epoch.h"

#include <cmath>
#include <numbers>

namespace pilotage::scene_detail {
namespace {

Eigen::Vector2d towards(double azimuth_deg) {
  const double azimuth_rad = azimuth_deg * std::numbers::pi / 180;
  return {std::sin(azimuth_rad), std::cos(azimuth_rad)};
}

double tangent(double angle_deg) {
  return std::tan(angle_deg * std::numbers::pi / 180);
}

}  // namespace

const EpochLook& epoch_look(SceneEpoch epoch) {
  static const EpochLook kFirst{.to_sun = towards(138),
                                .tan_elevation = tangent(51),
                                .gain = {1.02F, 1.02F, 1.00F},
                                .haze = 4,
                                .contrast = 1.0F,
                                .saturation = 0.84F,
                                .water_level_m = 0,
                                .foliage = 1};
  static const EpochLook kSecond{.to_sun = towards(214),
                                 .tan_elevation = tangent(36),
                                 .gain = {1.00F, 0.96F, 0.90F},
                                 .haze = 13,
                                 .contrast = 1.06F,
                                 .saturation = 0.80F,
                                 .water_level_m = -1.5F,
                                 .foliage = 0.93F};
  return epoch == SceneEpoch::kFirst ? kFirst : kSecond;
}

}  // namespace pilotage::scene_detail
