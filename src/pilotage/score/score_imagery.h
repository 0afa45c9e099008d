#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/mission/tile_table.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/score/score_second_epoch.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

/// Scoring of whole rasters, without a route.
struct ScoreImageryOptions {
  ScoreGridOptions grid;
  ScoreOptions score;
  ImageryOptions imagery;
  std::optional<double> gsd_m;
  std::string crs;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    ScoreGridOptions::describe(self.grid, fields);
    ScoreOptions::describe(self.score, fields);
    ImageryOptions::describe(self.imagery, fields);
    fields.field("gsd_m", self.gsd_m,
                 "Resample to this ground sample distance; without it the raster's own pixels are scored.",
                 Range{0.001, 100000});
    fields.field("crs", self.crs, "CRS of the grid to resample to, projected in metres; chosen if not given.");
  }
};

struct ScoredImagery {
  Crs crs;
  TileMatrix matrix;
  std::vector<TileRow> rows;  ///< All tiles, ascending tile_id = row · matrix_width + column.
  std::vector<std::string> warnings;
  std::optional<SecondEpoch> second_epoch;  ///< When score.second_epoch is given.
};

/// Scores every tile of a raster on its own pixel grid, with nothing resampled; or, with gsd_m (or crs, or several
/// rasters, which need a common grid), of the mosaic on a north-up grid in crs. Coordinates min_x_m … are the CRS's
/// axes in metres (feet are converted); they are NaN where the CRS counts degrees. Where the raster is rotated they are
/// the rectangle around the tile. Throws as score_tiles, inspect_imagery and choose_mission_crs; UsageError when there
/// is no raster, or gsd_m is missing for several.
ScoredImagery score_imagery(const std::vector<std::string>& datasets, const ScoreImageryOptions& options,
                            std::uint64_t seed = 1, int threads = 0, const Progress& progress = {});

}  // namespace pilotage
