#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "country/colour.h"

namespace pilotage {

/// The two dates of a scene: a morning in June, and an afternoon in late September of the next year by another camera.
enum class SceneEpoch : std::uint8_t { kFirst = 0, kSecond = 1 };

namespace scene_detail {

/// Light and camera of a date.
struct EpochLook {
  Eigen::Vector2d to_sun;    ///< Unit vector on the ground towards the sun: east, north.
  double tan_elevation = 1;  ///< Of the sun; a thing of height h throws a shadow of h / tan_elevation.
  Rgb gain;                  ///< Exposure and white balance.
  float haze = 0;            ///< Added to every channel.
  float contrast = 1;        ///< Exponent of the tone curve: above 1 is darker and harder.
  float saturation = 1;      ///< Of the camera's colours.
  float water_level_m = 0;   ///< Above the mean shore line.
  float foliage = 1;         ///< Size of broad-leaved crowns.
};

const EpochLook& epoch_look(SceneEpoch epoch);

inline int epoch_index(SceneEpoch epoch) {
  return static_cast<int>(epoch);
}

}  // namespace scene_detail
}  // namespace pilotage
