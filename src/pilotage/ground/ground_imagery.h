#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/ground/ground.h"
#include "pilotage/raster/color_source.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/raster/raster.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The imagery as GDAL dataset strings.
std::vector<std::string> dataset_names(const Imagery& imagery);

/// A ground's imagery on the grid of one of its levels, in its own depth. Throws as open_gray and open_gray_on_grid.
GraySource open_gray(const Ground& ground, const GridLevel& level);

/// A ground's imagery, opened once for all stages that read it: what one of them had decoded and warped the next one
/// finds in memory, as far as kImageryBytes go for all levels together, and for each level three rows of blocks as
/// share_blocks has them.
struct GroundImagery {
  std::vector<GrayAndColors> levels;  ///< levels[i] is of ground.levels[i], in the imagery's own depth.
};
inline constexpr std::int64_t kImageryBytes = std::int64_t{256} << 20;

/// Throws as open_gray and open_gray_and_colors_on_grid.
GroundImagery open_imagery(const Ground& ground);

/// A colour picture of the ground around all tiles, at most `max_side_px` on its longer side: what a person looks at.
/// Throws as read_rgb8_on_grid.
Raster read_overview(const Ground& ground, int max_side_px);

}  // namespace pilotage

#pragma GCC visibility pop
