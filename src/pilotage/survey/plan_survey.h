#pragma once

#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/camera/camera.h"
#include "pilotage/ground/ground.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/survey/survey_options.h"

namespace pilotage {

/// The imagery cut into tiles of a camera's footprint, before any of them is scored.
struct SurveyedGround {
  Ground ground;  ///< One level that serves one height; its tiles cover the rectangle around all imagery.
  std::vector<ImageryInfo> imagery_infos;  ///< Of the rasters, as they were named.
  Camera camera;
  std::string camera_name;  ///< As it is sold; "" where it was described otherwise.
  double agl_m = 0;
  double footprint_width_m = 0;  ///< Of a level flight.
  double footprint_height_m = 0;
  double search_radius_m = 0;
  bool search_radius_assumed = false;  ///< The planner named none.
  std::vector<std::string> warnings;   ///< What the planner should look at.
  std::vector<std::string> notes;      ///< What was chosen, and why.
};

/// Most tiles of a survey: its page holds all their numbers.
inline constexpr std::int64_t kMostSurveyedTiles = 100'000;

/// Cuts the whole area of the imagery as plan_tiles() cuts a corridor: pixels as choose_working_gsd says, a tile is the
/// square with the area of the footprint from `agl_m`, neighbours share tile_overlap of their side. The grid is
/// north-up in metres, in the imagery's CRS where that distorts little, with whole multiples of the pixel as origin.
///
/// Throws UsageError without imagery, camera or height, and when the elevation model is the imagery; DataError when a
/// raster cannot be used, when imagery looks like an elevation model (unless `bands` say that it is none) or an
/// elevation model like imagery, when a tile is larger than the imagery, and for more than kMostSurveyedTiles.
SurveyedGround plan_survey(const std::vector<std::string>& imagery, const SurveyOptions& options,
                           const Progress& progress = {});

}  // namespace pilotage
