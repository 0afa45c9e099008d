#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/ground/ground.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// How rasters without a plan are cut into tiles. What is not given has the default that its help names; a plan has a
/// grid of its own, and refuses all of them (refuse_raster_grid).
struct RasterGridOptions {
  std::optional<int> tile_size_px;
  std::optional<int> stride_px;
  std::optional<int> search_radius_px;
  ImageryOptions imagery;
  std::optional<double> gsd_m;
  std::string crs;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("tile_size_px", self.tile_size_px, "Side of a square tile. Default: 256.", Range{2, 4096});
    fields.field("stride_px", self.stride_px, "Distance between neighbouring tiles. Default: 64.", Range{1, 65536});
    fields.field("search_radius_px", self.search_radius_px,
                 "How far from its place a tile is looked for, in columns and rows. Default: 128.", Range{0, 4096});
    ImageryOptions::describe(self.imagery, fields);
    fields.field("gsd_m", self.gsd_m,
                 "Resample to this ground sample distance; without it the raster's own pixels are scored.",
                 Range{0.001, 100000});
    fields.field("crs", self.crs, "CRS of the grid to resample to, projected in metres; chosen if not given.");
  }
};

/// A ground without a route, and what a planner should know of its imagery.
struct RasterGround {
  Ground ground;
  std::vector<std::string> warnings;
};

/// The ground of a raster on its own pixel grid, with nothing resampled; or, with gsd_m (or crs, or several rasters,
/// which need a common grid), of the mosaic on a north-up grid in crs. It has one level and no tiles yet: cut_tiles.
/// Throws as inspect_imagery and choose_mission_crs; UsageError when there is no raster, or gsd_m is missing for
/// several; DataError naming both sizes when a tile is larger than the imagery.
RasterGround ground_of_rasters(const std::vector<std::string>& datasets, const RasterGridOptions& options,
                               const Progress& progress = {});

/// The ground alone, of rasters that were inspected with options.imagery; nothing is opened. Throws likewise.
Ground ground_of_inspected(const std::vector<ImageryInfo>& infos, const RasterGridOptions& options);

/// Dates as a planner states them, one for all rasters or one for each, in place of what these say; nothing happens
/// without. Throws UsageError when they are as many as neither, or one is no date.
void set_imagery_dates(const std::optional<std::vector<std::string>>& dates, std::vector<ImageryDataset>& datasets);

/// Gives a ground of one level tiles of its matrix, `indices` (ascending) or all of them; tile_id = row · matrix_width
/// + column. Throws DataError, before memory is taken, when these are more than kMostTiles.
void cut_tiles(Ground& ground, std::span<const std::int64_t> indices, int threads = 0);
void cut_all_tiles(Ground& ground, int threads = 0);

/// Throws UsageError, naming it, when one of the options is given: they are for rasters, and `plan` has its own grid.
void refuse_raster_grid(const RasterGridOptions& options, const std::string& plan);

}  // namespace pilotage

#pragma GCC visibility pop
