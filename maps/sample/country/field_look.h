#pragma once

#include "country/colour.h"
#include "country/epoch.h"

namespace pilotage::scene_detail {

/// How a crop looks at a date. Contrasts are shares of the brightness.
struct FieldLook {
  Rgb colour;
  Rgb soil;           ///< Seen in wheel tracks and thin places.
  float patches = 0;  ///< Contrast of soil patches, which both dates share.
  float mottle = 0;   ///< Contrast of growth of some metres, drawn anew at each date.
  float rows = 0;     ///< Contrast of plant or plough rows.
  float row_spacing_m = 1;
  float tramlines = 0;  ///< Opacity of wheel tracks.
  float swaths = 0;     ///< Contrast of straw lines.
  float grain = 0;      ///< Contrast of leaves and clods.
};

constexpr int kCropCount = 9;

/// `crop` in [0, kCropCount).
const FieldLook& field_look(int crop, SceneEpoch epoch);

/// Spacing of a sprayer's wheel tracks.
constexpr double kTramline_m = 24;

}  // namespace pilotage::scene_detail
