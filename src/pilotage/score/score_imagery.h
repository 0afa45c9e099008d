#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/raster/gdal_imagery.h"
#include "pilotage/raster/gray_source.h"
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

/// Rasters opened for scoring: on their own pixel grid, or a mosaic on a grid that they share.
struct OpenImagery {
  std::vector<std::string> datasets;
  bool own_grid = false;  ///< Of the one raster; nothing is resampled.
  Crs crs;
  GraySource source;
  TileMatrix matrix;
  std::vector<std::string> warnings;
};

/// Opens a raster on its own pixel grid, with nothing resampled; or, with gsd_m (or crs, or several rasters, which need
/// a common grid), the mosaic on a north-up grid in crs. Throws as inspect_imagery, score_matrix and
/// choose_mission_crs; UsageError when there is no raster, or gsd_m is missing for several.
OpenImagery open_imagery(const std::vector<std::string>& datasets, const ScoreImageryOptions& options);

/// Registers score.second_epoch over all tiles. Throws as register_epochs.
SecondEpoch register_second_epoch(const OpenImagery& imagery, const ScoreImageryOptions& options, int threads = 0,
                                  const Progress& progress = {});

/// Scores tiles by index (row · matrix_width + column); an empty list means all. Everything but the reasons is filled;
/// what a second date says when its registration's field is given. The same for a tile whichever others are asked for.
/// Throws as score_tiles, measure_ground_cover and score_epochs.
std::vector<TileScore> score_imagery_tiles(const OpenImagery& imagery, const ScoreImageryOptions& options,
                                           const std::vector<std::int64_t>& indices, const WarpField* second_epoch,
                                           std::uint64_t seed = 1, int threads = 0, const Progress& progress = {});

/// The rows of all tiles from the scores of all (ascending tile_id), which get their reasons.
std::vector<TileRow> imagery_rows(const OpenImagery& imagery, std::vector<TileScore> scores, int threads = 0);

struct ScoredImagery {
  Crs crs;
  TileMatrix matrix;
  std::vector<TileRow> rows;  ///< All tiles, ascending tile_id = row · matrix_width + column.
  std::vector<std::string> warnings;
  std::optional<SecondEpoch> second_epoch;  ///< When score.second_epoch is given.
};

/// Scores every tile of rasters: all of the above. Coordinates min_x_m … are the CRS's axes in metres (feet are
/// converted); they are NaN where the CRS counts degrees. Where the raster is rotated they are the rectangle around the
/// tile.
ScoredImagery score_imagery(const std::vector<std::string>& datasets, const ScoreImageryOptions& options,
                            std::uint64_t seed = 1, int threads = 0, const Progress& progress = {});

}  // namespace pilotage
